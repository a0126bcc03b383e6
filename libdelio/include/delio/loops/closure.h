#pragma once
#include <string>
#include <vector>

#include "core/voxel_table.h"
#include "delio/core/increment.h"
#include "delio/loops/submap.h"
#include "odometry/plane_map.h"
#include "odometry/point_map.h"
#include "odometry/register_planes.h"
#include "odometry/register_points.h"

namespace delio::loops {
/** When two submaps show one place. */
struct ClosureOptions : public StageOptions {
    double min_overlap = 0.3;
    double min_share = 0.5;
    double max_bare = 0.3;
    double agreed = 0.2;
    double agreed_deg = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A submap as others are registered to it: points that place, and planes that refine. Its level
 *  frame. */
class RegistrableSubmap {
 public:
    /** `points`: metres, the submap's level frame. */
    explicit RegistrableSubmap(const Eigen::Matrix3Xf& points);

    /** `other` to this, from `guess` on, which may be off by 2 m: by points, then by planes. */
    odometry::PlaneEstimate registered(const RegistrableSubmap& other,
                                     const Eigen::Isometry3d& guess) const;

    /** Of the one that fills fewer voxels of 0.5 m above the ground the share that both fill:
     *  Szymkiewicz and Simpson's coefficient, 0 to 1. (Ground lies on ground anywhere.) */
    double overlap(const RegistrableSubmap& other, const Eigen::Isometry3d& pose)
        const;  //!< RegistrableSubmap::overlap() where `to` was brought

    /** Of the voxels of 0.5 m that the other fills above the ground the share that this one fills,
     *  too; 0 to 1. Those above all that this one saw in that column are left out (a sensor sees so
     *  high only), 70 % at most. */
    double support(const RegistrableSubmap& other, const Eigen::Isometry3d& pose) const;

 private:
    odometry::PlaneMap planes_;
    odometry::PointMap points_;
    Eigen::Matrix3Xd coarse_, thinned_, standing_;
    VoxelIndex filled_;   //!< by what stands
    VoxelIndex columns_;  //!< of 1 m in which anything was seen
    std::vector<double> tops_;  //!< of each of them
};

/** What became of an attempt to bring two submaps together. */
struct Closure {
    Eigen::Isometry3d level = Eigen::Isometry3d::Identity();  //!< `to` to `from`, level frames
    Increment increment;  //!< `to` to `from`, the vehicle's frames at the key nodes
    double overlap = 0;   //!< of what stands in both: RegistrableSubmap::overlap()
    double share = 0;     //!< of the points in voxels with a plane those that lie on it
    std::string reason;   //!< why it is none; empty: it is one
};

/** A submap and what others are registered to. */
struct ClosureEnd {
    const Submap& submap;          //!< where it is in the drive
    const RegistrableSubmap& map;  //!< its points and planes
};

/** Registers `to` to `from`, from `guess` on. */
Closure closureOf(const ClosureEnd& from, const ClosureEnd& to, const Eigen::Isometry3d& guess,
                  const ClosureOptions& options);

/** Registers `from` to `to`, too: names a reason where not the same comes out. */
void confirm(Closure& closure, const ClosureEnd& from, const ClosureEnd& to,
             const ClosureOptions& options);
}  // namespace delio::loops
