#pragma once
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "core/voxel_table.h"
#include "delio/core/increment.h"
#include "delio/places/loops.h"
#include "delio/places/submap.h"
#include "odometry/local_map.h"
#include "odometry/range_image.h"
#include "places/descriptor.h"

namespace delio::places {
/** Fraction of what stands in one submap that may be where the other saw bare ground. With 0.3
 *  benchmark_loops closes no wrong loop (share/doc/method/loops.md). */
constexpr double kMaxFreeSpaceConflict = 0.3;

/** Error of a registration of two submaps beside its noise: drift within a submap bends it. */
struct Bending {
    double metres;   //!< standard deviation along each axis
    double radians;  //!< the same about each axis

    /** Of [x y z wx wy wz]. */
    Vector6 variances() const {
        Vector6 result;
        result << Eigen::Vector3d::Constant(metres * metres),
            Eigen::Vector3d::Constant(radians * radians);
        return result;
    }
};
/** For loops: both submaps are of one drive, as its odometry left them. */
constexpr Bending kBendingInDrive{0.05, 0.2 * M_PI / 180};
/** For what is measured in a stored map, which was optimised: smaller than in a drive. */
constexpr Bending kBendingInMap{0.02, 1e-3};

/** A submap to which others are registered, first by points, then by planes. Its level frame. */
class RegistrableSubmap {
 public:
    /** `points`: metres, the submap's level frame. */
    explicit RegistrableSubmap(const Eigen::Matrix3Xf& points);

    /** Registers `other` to this submap. The initial guess may be off by 2 m. */
    odometry::PlaneEstimate registered(const RegistrableSubmap& other,
                                       const Eigen::Isometry3d& guess) const;

    /** Overlap coefficient (Szymkiewicz and Simpson) of the voxels of 0.5 m that the two fill above
     *  the ground, 0 to 1: those that both fill, divided by the smaller set. Ground and ceilings
     * are left out, as they match anywhere. `pose`: other to this. */
    double overlap(const RegistrableSubmap& other, const Eigen::Isometry3d& pose) const;

    /** Fraction of the other's voxels of 0.5 m above the ground that this one fills as well, 0
     * to 1. Voxels higher than anything that this one saw in the column are not counted (a sensor
     * does not see higher), but at most 70 % of them. */
    double support(const RegistrableSubmap& other, const Eigen::Isometry3d& pose) const;

    /** Fraction of the other's points within 0.15 m of one of this one's, 0 to 1: less than
     *  support() where only similar things are there. */
    double closeness(const RegistrableSubmap& other, const Eigen::Isometry3d& pose) const {
        return map_.shareAt(other.coarse_, pose, kClose_m);
    }

    /** Of what stands here and what a scan saw or saw through, the fraction that it saw through, 0
     *  to 1. `pose`: the scan to this. */
    double seenThrough(const odometry::RangeImage& scan, const Eigen::Isometry3d& pose) const;

 private:
    static constexpr double kClose_m = 0.15;

    odometry::LocalMap map_;
    Eigen::Matrix3Xd coarse_, thinned_, standing_;
    VoxelIndex filled_;         //!< by what is above the ground
    std::size_t count_ = 0;     //!< of those that what stands fills
    VoxelIndex columns_;        //!< of 1 m in which anything was seen
    std::vector<double> tops_;  //!< of each of them
};

/** One of the two submaps that are registered. */
struct ClosureEnd {
    const Submap& submap;          //!< where it is in the drive
    const RegistrableSubmap& map;  //!< its points and planes
};

/** Registers `to` to `from`. `guess`: initial guess. */
Closure closureOf(const ClosureEnd& from, const ClosureEnd& to, const Eigen::Isometry3d& guess,
                  const ClosureOptions& options);

/** Registers `from` to `to` as well, and refuses the closure if the two results differ. */
void confirm(Closure& closure, const ClosureEnd& from, const ClosureEnd& to,
             const ClosureOptions& options);

/** Cells in which a levelled cloud has ground and nothing on it, seen from above. */
class FreeSpace {
 public:
    /** `image`: of the same points. */
    FreeSpace(const HeightImage& image, const Eigen::Matrix3Xf& points);

    /** Takes the cells in which the other cloud is filled from 1 to 4 m (a wall, a hedge, a trunk)
     *  and which this one observed, and gives the fraction that this one saw as bare ground.
     *  Less with fewer than 20 such cells, 0 without. `pose`: other to this. */
    double conflict(const HeightImage& other, const Eigen::Isometry3d& pose) const;

 private:
    VoxelIndex bare_, standing_;  //!< cells: ground with nothing on it or beside it; others
};

/** What verification needs of a submap: 10 to 20 MB. */
struct DenseSubmap {
    RegistrableSubmap map;  //!< its points and planes
    FreeSpace free;         //!< what it saw to be empty

    /** `image`: of the same points. */
    DenseSubmap(const Eigen::Matrix3Xf& points, const HeightImage& image)
        : map(points), free(image, points) {}
};

/** Keeps the submaps that were used last. */
class DenseSubmapCache {
 public:
    /** `most`: how many. */
    explicit DenseSubmapCache(std::size_t most) : most_(most) {}

    /** `make` is called if the submap is not kept. */
    std::shared_ptr<const DenseSubmap> at(std::size_t submap,
                                          const std::function<DenseSubmap()>& make);

 private:
    struct Recent {
        std::size_t submap;
        std::shared_ptr<const DenseSubmap> dense;
    };
    std::size_t most_;
    std::deque<Recent> recent_;  //!< the latest first
};
}  // namespace delio::places
