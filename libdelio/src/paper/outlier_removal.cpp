#include "paper/outlier_removal.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/kd_tree.h"

namespace delio::paper {
namespace {
using Numbers = std::vector<Eigen::Index>;

/** Of each direction the nearest ones, found once: the nearest of those that are left later are
 *  among them, too, but for a few. */
class Nearest {
 public:
    /** `directions` have to outlive it; each is one of its own nearest, of which it keeps `most`,
     *  but no more than memory is there for. */
    Nearest(const Eigen::Matrix3Xf& directions, std::size_t most)
        : directions_(directions),
          most_(std::min({most, static_cast<std::size_t>(directions.cols()), kMost})),
          indices_(most_ * static_cast<std::size_t>(directions.cols())),
          squared_(indices_.size()) {
        const KdTree tree(directions_);
        forEach(directions_.cols(), [&](Eigen::Index i) {
            const std::size_t first = most_ * static_cast<std::size_t>(i);
            tree.nearest(directions_.col(i), most_, &indices_[first], &squared_[first]);
        });
    }

    /** Of each of those that are `left` the mean chord to the nearest `count` others of them. */
    Eigen::VectorXf meanDistances(const Numbers& left, std::size_t count) const {
        std::vector<char> isLeft(static_cast<std::size_t>(directions_.cols()), 0);
        for (const Eigen::Index i : left) isLeft[static_cast<std::size_t>(i)] = 1;
        const std::size_t wanted = std::min(count + 1, left.size());
        Eigen::VectorXf means(static_cast<Eigen::Index>(left.size()));
        forEach(means.size(), [&](Eigen::Index k) {
            const std::size_t first =
                most_ * static_cast<std::size_t>(left[static_cast<std::size_t>(k)]);
            float sum = 0;
            std::size_t found = 0;
            for (std::size_t j = first; j < first + most_ && found < wanted; ++j) {
                if (!isLeft[indices_[j]]) continue;
                sum += std::sqrt(squared_[j]);
                ++found;
            }
            means[k] = found < wanted ? kUnknown : meanOf(sum, found);
        });
        if ((means.array() == kUnknown).any()) askAgain(left, wanted, means);
        return means;
    }

 private:
    static constexpr std::size_t kMost = 100;
    static constexpr float kUnknown = -1;

    template <typename Do>
    static void forEach(Eigen::Index count, const Do& work) {
        tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, count, 128), [&](const auto& range) {
            for (Eigen::Index i = range.begin(); i != range.end(); ++i) work(i);
        });
    }

    /** One of them is the direction itself. */
    static float meanOf(float sum, std::size_t found) {
        return found > 1 ? sum / static_cast<float>(found - 1) : 0.0F;
    }

    /** Those of which too few are left. */
    void askAgain(const Numbers& left, std::size_t wanted, Eigen::VectorXf& means) const {
        const Eigen::Matrix3Xf others = directions_(Eigen::all, left);
        const KdTree tree(others);
        forEach(means.size(), [&](Eigen::Index k) {
            if (means[k] != kUnknown) return;
            std::vector<std::uint32_t> indices(wanted);
            std::vector<float> squared(wanted);
            tree.nearest(others.col(k), wanted, indices.data(), squared.data());
            float sum = 0;
            for (const float chord : squared) sum += std::sqrt(chord);
            means[k] = meanOf(sum, wanted);
        });
    }

    const Eigen::Matrix3Xf& directions_;
    std::size_t most_;
    std::vector<std::uint32_t> indices_;
    std::vector<float> squared_;
};

void keepOnly(const Numbers& kept, Pattern& pattern) {
    pattern.removed += static_cast<std::size_t>(pattern.directions.cols()) - kept.size();
    pattern.normals = kept.size();
    pattern.directions = pattern.directions(Eigen::all, kept).eval();
    pattern.weights = pattern.weights(kept).eval();
    if (pattern.points.cols() > 0) pattern.points = pattern.points(Eigen::all, kept).eval();
}
}  // namespace

Pattern patternOf(const SurfaceNormals& normals) {
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

Pattern removeOutliers(const SurfaceNormals& normals, const OutlierRemovalOptions& options) {
    Pattern pattern = patternOf(normals);
    if (options.rounds == 0) return pattern;
    const auto neighboursOf = [&](unsigned round) {
        return static_cast<std::size_t>(std::lround(options.neighboursOf(round)));
    };
    const Nearest nearest(normals.directions,
                          1 + std::max(neighboursOf(0), neighboursOf(options.rounds - 1)));
    Numbers left(pattern.normals);
    std::iota(left.begin(), left.end(), Eigen::Index{0});
    for (unsigned round = 0; round < options.rounds && left.size() > 1; ++round) {
        const Eigen::VectorXf means = nearest.meanDistances(left, neighboursOf(round));
        const float mean = means.mean();
        const float sigma = std::sqrt((means.array() - mean).square().mean());
        const float reach = static_cast<float>(options.alpha) * sigma;
        const float least = options.both_ends ? mean - reach : 0;
        Numbers kept;
        for (Eigen::Index i = 0; i < means.size(); ++i)
            if (means[i] >= least && means[i] <= mean + reach)
                kept.push_back(left[static_cast<std::size_t>(i)]);
        const auto before = static_cast<double>(left.size()),
                   now = static_cast<double>(kept.size());
        left = std::move(kept);
        ++pattern.rounds;
        if (now <= options.small_share * static_cast<double>(normals.directions.cols()) ||
            before - now < options.stable_share * before)
            break;
    }
    keepOnly(left, pattern);
    return pattern;
}
}  // namespace delio::paper
