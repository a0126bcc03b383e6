#pragma once
#include <Eigen/Core>
#include <limits>

#include "delio/core/stage_options.h"
#include "delio/scan/voxel_table.h"

namespace delio::points {
struct PointMapOptions : public StageOptions {
    double voxel_size = 1.0;
    double spacing = 0.2;
    double radius = 120;

 protected:
    std::vector<OptionField> fields() const override;
};

/** What the last scans saw, as points in voxels (Vizzo et al., KISS-ICP): the first ones of a voxel
 *  that are `spacing` apart. Metres, the map's frame. Memory is bounded by `radius`. */
class PointMap {
 public:
    explicit PointMap(const PointMapOptions& options) : options_(options) {}

    void add(const Eigen::Matrix3Xd& points);

    /** Drops what lies within `spacing` of one of `points` in its voxel: what was taken for a part
     *  of the world is none. */
    void erase(const Eigen::Matrix3Xd& points);

    /** Drops what lies farther than `radius` from `centre`. */
    void forgetFarFrom(const Eigen::Vector3d& centre);

    void clear();

    std::size_t size() const { return size_; }  //!< points

    /** The nearest point within `reach` metres, which are at most a voxel's edge; none: false. */
    bool nearest(const Eigen::Vector3d& point, double reach, Eigen::Vector3d& found) const;

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(cells_, size_);
    }

 private:
    struct Cell {
        static constexpr Eigen::Index kMost = 20;
        static constexpr Eigen::Index kTogether = 4;  //!< compared at once
        using Distances = Eigen::Array<float, kTogether, 1>;

        Eigen::Vector3d origin;  //!< the first point: the others are seen from there
        /** A row each. Rows without one lie infinitely far away. */
        Eigen::Array<float, kMost, 3> points =
            Eigen::Array<float, kMost, 3>::Constant(std::numeric_limits<float>::infinity());
        Eigen::Index count = 0;

        /** Squared, of the points from `first` on; `local`: seen from the origin. */
        Distances distances(Eigen::Index first, const Eigen::Vector3f& local) const {
            const auto squared = [&](Eigen::Index axis) {
                return (points.col(axis).segment<kTogether>(first) - local[axis]).square();
            };
            return squared(0) + (squared(1) + squared(2));
        }

        bool nearest(const Eigen::Vector3d& point, float& least, Eigen::Vector3d& found) const;

        template <class Archive>
        void serialize(Archive& archive) {
            Eigen::Array<float, Eigen::Dynamic, 3, Eigen::ColMajor, kMost, 3> taken =
                points.topRows(count);
            archive(origin, taken);
            count = taken.rows();
            points.topRows(count) = taken;
        }
    };
    PointMapOptions options_;
    scan::VoxelTable<Cell> cells_;
    std::size_t size_ = 0;
};
}  // namespace delio::points
