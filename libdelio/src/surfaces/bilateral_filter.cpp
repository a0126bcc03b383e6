#include "delio/surfaces/bilateral_filter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "../core/kd_tree.h"
#include "../core/portable_math.h"

namespace delio::surfaces {
std::vector<OptionField> BilateralFilterOptions::fields() const {
    return {{"neighbours", &BilateralFilterOptions::neighbours,
             "nearest normals that one is averaged over; 0: no filter", 0, 1000},
            {"distance_sigma", &BilateralFilterOptions::distance_sigma,
             "m; width of the kernel over distance in space", 0.001, 100},
            {"angle_sigma_deg", &BilateralFilterOptions::angle_sigma_deg,
             "deg; width of the kernel over the angle", 0.01, 180}};
}

SurfaceNormals filterBilaterally(const SurfaceNormals& normals,
                                 const BilateralFilterOptions& options) {
    if (options.neighbours == 0) return normals;
    const double angle_sigma = options.angle_sigma_deg * M_PI / 180;
    const auto perDistance =
        static_cast<float>(-0.5 / (options.distance_sigma * options.distance_sigma));
    const auto perAngle = static_cast<float>(-0.5 / (angle_sigma * angle_sigma));
    const KdTree tree(normals.points);
    SurfaceNormals filtered = normals;
    tbb::parallel_for(
        tbb::blocked_range<Eigen::Index>(0, normals.points.cols(), 128),
        [&](const tbb::blocked_range<Eigen::Index>& range) {
            // The nearest one is the normal itself.
            std::vector<std::uint32_t> indices(options.neighbours + 1);
            std::vector<float> squared(options.neighbours + 1);
            for (Eigen::Index i = range.begin(); i != range.end(); ++i) {
                const std::size_t found = tree.nearest(normals.points.col(i), indices.size(),
                                                       indices.data(), squared.data());
                const Eigen::Vector3f own = normals.directions.col(i);
                Eigen::Vector3f sum = Eigen::Vector3f::Zero();
                for (std::size_t j = 0; j < found; ++j) {
                    const auto other = normals.directions.col(indices[j]);
                    // The chord stands for the angle: they differ by 1 % at 28 deg.
                    const float weight = normals.planarity[indices[j]] *
                                         portable::exp(perDistance * squared[j] +
                                                       perAngle * (other - own).squaredNorm());
                    sum += weight * other;
                }
                const float length = sum.norm();
                if (length > 0) filtered.directions.col(i) = sum / length;
            }
        });
    return filtered;
}
}  // namespace delio::surfaces
