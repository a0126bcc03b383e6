#include "paper/normals.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <cmath>

#include "core/kd_tree.h"
#include "core/portable_math.h"
#include "core/principal_axes.h"
#include "core/voxel_grid.h"

namespace delio::paper {
namespace {
enum class Shape : unsigned char { kPlane, kLine, kRough };

struct Neighbourhood {
    Shape shape = Shape::kRough;
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();
    float planarity = 0;
};

Neighbourhood examine(const Eigen::Matrix3Xf& points, const Eigen::Vector3f& centre,
                      const KdTree& tree, const NormalsOptions& options) {
    std::vector<std::uint32_t> indices(options.neighbours);
    std::vector<float> distances(options.neighbours);
    const std::size_t found =
        tree.nearest(centre, options.neighbours, indices.data(), distances.data());
    const double reach = options.max_radius * options.max_radius;
    // Relative to the query point: float keeps its digits there.
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
    float count = 0;
    for (std::size_t i = 0; i < found && distances[i] <= static_cast<float>(reach); ++i) {
        const Eigen::Vector3f p = points.col(indices[i]) - centre;
        sum += p;
        squares += p * p.transpose();
        count += 1;
    }
    Neighbourhood result;
    if (count < 5) return result;  // three points always lie in a plane
    const Eigen::Vector3f mean = sum / count;
    const Eigen::Matrix3f scatter = squares / count - mean * mean.transpose();
    const auto pca = principalAxes(scatter.cast<double>());
    // Ascending: thickness, breadth and length of the neighbourhood, squared.
    const Eigen::Vector3f size = pca.variances.cast<float>().cwiseMax(0.0F).cwiseSqrt();
    if (!(size[2] > 0) || size[1] < static_cast<float>(options.min_breadth) * size[2]) {
        result.shape = Shape::kLine;
        return result;
    }
    const float thickness = size[0] / size[1];
    if (thickness > static_cast<float>(options.max_thickness)) return result;
    result.shape = Shape::kPlane;
    result.planarity = 1 - thickness;
    result.normal = pca.axes.col(0).cast<float>().normalized();
    if (result.normal.dot(centre) > 0) result.normal = -result.normal;
    return result;
}
}  // namespace

SurfaceNormals estimateNormals(const Eigen::Matrix3Xf& points, const NormalsOptions& options,
                               Eigen::Index most) {
    const Eigen::Matrix3Xf thinned = voxelCentroids(points, options.voxel_size);
    const KdTree tree(thinned);
    using Numbers = Eigen::RowVectorX<Eigen::Index>;
    const Numbers all = Numbers::LinSpaced(thinned.cols(), 0, thinned.cols() - 1),
                  voxels = sample(all, most);
    std::vector<Neighbourhood> found(static_cast<std::size_t>(voxels.cols()));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, found.size(), 256),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i)
                              found[i] = examine(thinned,
                                                 thinned.col(voxels[static_cast<Eigen::Index>(i)]),
                                                 tree, options);
                      });
    SurfaceNormals result;
    result.neighbourhoods = found.size();
    result.directions.resize(3, voxels.cols());
    result.points.resize(3, voxels.cols());
    result.planarity.resize(voxels.cols());
    result.voxels.resize(voxels.cols());
    Eigen::Index kept = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto& neighbourhood = found[i];
        result.lines += neighbourhood.shape == Shape::kLine;
        result.rough += neighbourhood.shape == Shape::kRough;
        if (neighbourhood.shape != Shape::kPlane) continue;
        result.directions.col(kept) = neighbourhood.normal;
        result.planarity[kept] = neighbourhood.planarity;
        result.voxels[kept] = voxels[static_cast<Eigen::Index>(i)];
        result.points.col(kept) = thinned.col(result.voxels[kept]);
        ++kept;
    }
    result.directions.conservativeResize(3, kept);
    result.points.conservativeResize(3, kept);
    result.planarity.conservativeResize(kept);
    result.voxels.conservativeResize(kept);
    return result;
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
}  // namespace delio::paper
