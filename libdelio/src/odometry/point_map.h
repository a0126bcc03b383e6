#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/voxel_grid.h"
#include "core/voxel_table.h"
#include "delio/core/odometry_options.h"

namespace delio::odometry {
/** What the last scans saw, as points in voxels (Vizzo et al., KISS-ICP): the first ones of a voxel
 *  that are `spacing` apart. Metres, the map's frame. Memory is bounded by `radius`. */
class PointMap {
 public:
    /** An empty one. */
    explicit PointMap(const PointMapOptions& options) : options_(options) {}

    /** Takes points (metres, the map's frame) in. */
    void add(const Eigen::Matrix3Xd& points);

    /** Drops points within `spacing` of one of `points`, which are dynamic, in its voxel. */
    void erase(const Eigen::Matrix3Xd& points);

    /** Drops what lies farther than `radius` from `centre`. */
    void forgetFarFrom(const Eigen::Vector3d& centre);

    /** Drops everything. */
    void clear();

    std::size_t size() const { return size_; }  //!< points

    /** What nearest() finds. */
    struct Nearest {
        bool any = false;                                 //!< there is one
        Eigen::Vector3d point = Eigen::Vector3d::Zero();  //!< metres, the map's frame
        double others_m = 0;                              //!< all others are farther away
    };
    /** The nearest point within `reach` metres, and never farther than a voxel's edge, if there is
     *  any; and a distance, metres, within which no other one lies. */
    Nearest nearest(const Eigen::Vector3d& point, double reach) const {
        return nearestOf(point, reach).front();
    }
    /** The same of each of many points, whose memory accesses overlap. */
    std::vector<Nearest> nearestOf(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                   double reach) const;

    /** Calls visit(point) of each (metres, the map's frame). */
    template <typename Visit>
    void forEachPoint(const Visit& visit) const {
        for (std::uint32_t number = 0; number < cells_.size(); ++number) {
            const Cell& cell = cells_[number];
            for (std::uint32_t i = 0; i < cell.count; ++i)
                visit(cell.origin + cell.point(i).cast<double>());
        }
    }

 private:
    /** Points that are compared at once, seen from their cell's origin. Places without a point lie
     *  infinitely far away. */
    struct Group {
        static constexpr Eigen::Index kSize = 4;
        using Values = Eigen::Array<float, kSize, 1>;

        Values x = Values::Constant(std::numeric_limits<float>::infinity()), y = x, z = x;

        Values squaredDistances(const Eigen::Vector3f& point) const {
            return (x - point.x()).square() + ((y - point.y()).square() + (z - point.z()).square());
        }
    };
    struct Other;
    struct Search;
    /** What is asked first lies first: cells are many, and memory is slow. */
    struct Cell {
        static constexpr Eigen::Index kMost = 20;

        //! The first point: the others are seen from there.
        Eigen::Vector3d origin = Eigen::Vector3d::Zero();
        std::uint32_t count = 0;
        std::array<Group, kMost / Group::kSize> groups;

        Eigen::Index groupsTaken() const { return (count + Group::kSize - 1) / Group::kSize; }
        Eigen::Vector3f point(std::uint32_t number) const;
        void set(std::uint32_t number, const Eigen::Vector3f& point);
        bool add(const Eigen::Vector3d& point, float squaredSpacing);
        void nearest(const Eigen::Vector3d& point, Search& search) const;
    };
    static constexpr Eigen::Index kBlock = 64;
    void findInBlock(const Eigen::Ref<const Eigen::Matrix3Xd>& points, double reach,
                     Nearest* found) const;

    PointMapOptions options_;
    VoxelTable<Cell> cells_;
    std::size_t size_ = 0;
};
}  // namespace delio::odometry
