#include "delio/paper/outlier_removal.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "../core/kd_tree.h"

namespace delio::paper {
namespace {
Eigen::VectorXf meanNeighbourDistances(const Eigen::Matrix3Xf& directions, std::size_t neighbours) {
    const KdTree tree(directions);
    Eigen::VectorXf means(directions.cols());
    tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, directions.cols(), 128),
                      [&](const tbb::blocked_range<Eigen::Index>& range) {
                          // The nearest one is the normal itself.
                          std::vector<std::uint32_t> indices(neighbours + 1);
                          std::vector<float> squared(neighbours + 1);
                          for (Eigen::Index i = range.begin(); i != range.end(); ++i) {
                              const std::size_t found =
                                  tree.nearest(directions.col(i), indices.size(), indices.data(),
                                               squared.data());
                              float sum = 0;
                              for (std::size_t j = 0; j < found; ++j) sum += std::sqrt(squared[j]);
                              means[i] = found > 1 ? sum / static_cast<float>(found - 1) : 0.0F;
                          }
                      });
    return means;
}

void keepOnly(const std::vector<Eigen::Index>& kept, Pattern& pattern) {
    pattern.removed += static_cast<std::size_t>(pattern.directions.cols()) - kept.size();
    pattern.normals = kept.size();
    pattern.directions = pattern.directions(Eigen::all, kept).eval();
    pattern.weights = pattern.weights(kept).eval();
    if (pattern.points.cols() > 0) pattern.points = pattern.points(Eigen::all, kept).eval();
}
}  // namespace

std::vector<OptionField> OutlierRemovalOptions::fields() const {
    return {{"rounds", &OutlierRemovalOptions::rounds,
             "times that outliers are looked for; 0: not at all", 0, 100},
            {"first_neighbours", &OutlierRemovalOptions::first_neighbours,
             "neighbours on the sphere in the first round", 1, 1e4},
            {"last_neighbours", &OutlierRemovalOptions::last_neighbours,
             "neighbours on the sphere in the last round", 1, 1e4},
            {"alpha", &OutlierRemovalOptions::alpha,
             "standard deviations above the mean that still belong", 0, 100}};
}

double OutlierRemovalOptions::neighboursOf(unsigned round) const {
    const double step = rounds > 1 ? static_cast<double>(round) / (rounds - 1) : 0;
    return first_neighbours + step * (static_cast<double>(last_neighbours) - first_neighbours);
}

OutlierRemovalOptions OutlierRemovalOptions::firstRounds(unsigned count) const {
    OutlierRemovalOptions first = *this;
    first.rounds = std::min(count, rounds);
    if (first.rounds > 0)
        first.last_neighbours = static_cast<unsigned>(std::lround(neighboursOf(first.rounds - 1)));
    return first;
}

Pattern patternOf(const surfaces::SurfaceNormals& normals) {
    return {normals.directions, normals.planarity,
            static_cast<std::size_t>(normals.directions.cols()), 0, normals.points};
}

Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axesOf(const Pattern& pattern) {
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
    double weights = 0;
    for (Eigen::Index i = 0; i < pattern.directions.cols(); ++i) {
        const Eigen::Vector3d n = pattern.directions.col(i).cast<double>();
        mean += static_cast<double>(pattern.weights[i]) *
                (Eigen::Matrix3d::Identity() - n * n.transpose());
        weights += static_cast<double>(pattern.weights[i]);
    }
    if (weights > 0) mean /= weights;
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(mean);
}

Pattern removeOutliers(const surfaces::SurfaceNormals& normals,
                       const OutlierRemovalOptions& options) {
    Pattern pattern = patternOf(normals);
    for (unsigned round = 0; round < options.rounds && pattern.directions.cols() > 1; ++round) {
        const double neighbours = options.neighboursOf(round);
        const Eigen::VectorXf means = meanNeighbourDistances(
            pattern.directions, static_cast<std::size_t>(std::lround(neighbours)));
        const float mean = means.mean();
        const float sigma = std::sqrt((means.array() - mean).square().mean());
        std::vector<Eigen::Index> kept;
        for (Eigen::Index i = 0; i < means.size(); ++i)
            if (means[i] <= mean + static_cast<float>(options.alpha) * sigma) kept.push_back(i);
        keepOnly(kept, pattern);
    }
    return pattern;
}
}  // namespace delio::paper
