#include "paper/mean_shift.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>

#include "core/kd_tree.h"
#include "core/portable_math.h"
#include "core/voxel_grid.h"
#include "paper/sphere.h"

namespace delio::paper {
namespace {
constexpr double kDeg = M_PI / 180;

/** Square of the chord that an angle spans on the unit sphere. */
float squaredChord(double angle) {
    const double chord = 2 * portable::sin(std::min(angle, M_PI) / 2);
    return static_cast<float>(chord * chord);
}

/** One step, the equation of section III-C: the kernel-weighted mean of the tangent plane's
 *  coordinates of all normals in the window. The k-d tree's ball is the cone
 *  |n x f| < sin(theta/2) without its antipodal half. */
Eigen::Vector3d meanShift(const Eigen::Matrix3Xf& directions, const KdTree& tree,
                          const Eigen::Vector3d& centre, double window, std::size_t& support) {
    std::vector<std::pair<std::uint32_t, float>> inside;
    tree.within(centre.cast<float>(), squaredChord(window / 2), inside);
    // c: the kernel has fallen to 1 % at the window's edge.
    const double c = -std::log(0.01) / (window * window / 4);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    for (const auto& [index, squared] : inside) {
        const Eigen::Vector3d m = sphereLog(centre, directions.col(index).cast<double>());
        const double weight = double{portable::exp(static_cast<float>(-c * m.squaredNorm()))};
        sum += weight * m;
        weights += weight;
    }
    support = inside.size();
    return weights > 0 ? Eigen::Vector3d(sum / weights) : Eigen::Vector3d::Zero();
}

Mode climb(const Eigen::Matrix3Xf& directions, const KdTree& tree, const Eigen::Vector3d& seed,
           const MeanShiftOptions& options) {
    Mode mode{seed, 0};
    for (unsigned i = 0; i < options.max_iterations; ++i) {
        const Eigen::Vector3d step =
            meanShift(directions, tree, mode.direction, options.window_deg * kDeg, mode.support);
        mode.direction = sphereExp(mode.direction, step);
        if (step.norm() < options.converged_deg * kDeg) break;
    }
    return mode;
}

SurfaceNormals subset(const SurfaceNormals& normals, const std::vector<Eigen::Index>& of) {
    SurfaceNormals result;
    result.directions = normals.directions(Eigen::all, of);
    result.planarity = normals.planarity(of);
    return result;
}

/** One direction a cell: the centroid, whose weight is the mean of the weights. */
void thin(Pattern& pattern, double cell) {
    const auto cells = numberVoxels(pattern.directions, cell);
    const auto [weights, counts] = sumsOf<1>(pattern.weights.transpose(), cells);
    pattern.directions = sumsOf<3>(pattern.directions, cells).sums.colwise().normalized();
    pattern.weights = weights.cwiseQuotient(counts).transpose();
}
}  // namespace

std::vector<Mode> seekModes(const Eigen::Matrix3Xf& directions, const MeanShiftOptions& options) {
    const KdTree tree(directions);
    const Eigen::Matrix3Xd seeds = sphereGrid(options.seed_spacing_deg);
    std::vector<Mode> climbed(static_cast<std::size_t>(seeds.cols()));
    tbb::parallel_for(std::size_t{0}, climbed.size(), [&](std::size_t i) {
        climbed[i] = climb(directions, tree, seeds.col(static_cast<Eigen::Index>(i)), options);
    });
    std::stable_sort(climbed.begin(), climbed.end(),
                     [](const Mode& a, const Mode& b) { return a.support > b.support; });
    std::vector<Mode> modes;
    for (const Mode& mode : climbed) {
        if (mode.support < options.min_support) break;
        const auto isEqual = [&](const Mode& other) {
            return sphereLog(mode.direction, other.direction).norm() < options.merge_deg * kDeg;
        };
        if (std::none_of(modes.begin(), modes.end(), isEqual)) modes.push_back(mode);
    }
    return modes;
}

bool needsModes(const Pattern& pattern, const MeanShiftOptions& options) {
    return pattern.normals < options.min_pattern ||
           axesOf(pattern).eigenvalues()[0] < options.min_observability;
}

Pattern patternOfModes(const SurfaceNormals& normals, const std::vector<Mode>& modes,
                       const MeanShiftOptions& options, const OutlierRemovalOptions& outliers) {
    const KdTree tree(normals.directions);
    Pattern all;
    all.directions.resize(3, 0);
    std::vector<bool> taken(static_cast<std::size_t>(normals.directions.cols()), false);
    for (const Mode& mode : modes) {
        std::vector<std::pair<std::uint32_t, float>> ball;
        tree.within(mode.direction.cast<float>(), squaredChord(options.ball_deg * kDeg), ball);
        std::vector<Eigen::Index> fresh;
        for (const auto& [index, squared] : ball) {
            if (taken[index]) continue;
            taken[index] = true;
            fresh.push_back(index);
        }
        const Pattern cleaned = removeOutliers(subset(normals, fresh), outliers);
        all.normals += cleaned.normals;
        const Eigen::Index before = all.directions.cols(), more = cleaned.directions.cols();
        all.directions.conservativeResize(3, before + more);
        all.directions.rightCols(more) = cleaned.directions;
        all.weights.conservativeResize(before + more);
        all.weights.tail(more) = cleaned.weights;
    }
    all.removed = static_cast<std::size_t>(normals.directions.cols()) - all.normals;
    thin(all, options.cell_deg * kDeg);
    return all;
}
}  // namespace delio::paper
