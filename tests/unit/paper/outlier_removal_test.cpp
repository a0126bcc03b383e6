#include "paper/outlier_removal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::removeOutliers;
using paper::SurfaceNormals;

constexpr Eigen::Index kBlob = 600, kScattered = 30;

/** Normals within some 6 deg of an axis, then scattered ones far from it. The planarities are the
 *  column's number, so that each normal can be told afterwards. */
SurfaceNormals blobAndScattered() {
    test::Noise noise;
    SurfaceNormals normals;
    normals.directions.resize(3, kBlob + kScattered);
    normals.planarity = Eigen::VectorXf::LinSpaced(kBlob + kScattered, 0, kBlob + kScattered - 1);
    for (Eigen::Index i = 0; i < kBlob + kScattered;) {
        const Eigen::Vector3d n =
            i < kBlob ? Eigen::Vector3d(Eigen::Vector3d(0, 0, 1) + 0.03 * noise.normals())
                      : noise.direction();
        if (i >= kBlob && n.z() > 0.8) continue;
        normals.directions.col(i++) = n.normalized().cast<float>();
    }
    return normals;
}

/** Columns that one round keeps, the plainest way. */
std::vector<float> keptOfOneRound(const SurfaceNormals& normals, std::size_t k, double alpha) {
    const Eigen::Matrix3Xd n = normals.directions.cast<double>();
    Eigen::VectorXd means(n.cols());
    for (Eigen::Index i = 0; i < n.cols(); ++i) {
        std::vector<double> distances;
        for (Eigen::Index j = 0; j < n.cols(); ++j)
            if (j != i) distances.push_back((n.col(i) - n.col(j)).norm());
        std::sort(distances.begin(), distances.end());
        distances.resize(std::min(k, distances.size()));
        double sum = 0;
        for (const double d : distances) sum += d;
        means[i] = sum / static_cast<double>(distances.size());
    }
    const double mean = means.mean(), sigma = std::sqrt((means.array() - mean).square().mean());
    std::vector<float> kept;
    for (Eigen::Index i = 0; i < n.cols(); ++i)
        if (means[i] <= mean + alpha * sigma) kept.push_back(normals.planarity[i]);
    return kept;
}

std::vector<float> keptOf(const paper::Pattern& pattern) {
    return {pattern.weights.data(), pattern.weights.data() + pattern.weights.size()};
}

OutlierRemovalOptions rounds(unsigned count, unsigned first = 40, unsigned last = 10) {
    OutlierRemovalOptions options;
    options.rounds = count;
    options.first_neighbours = first;
    options.last_neighbours = last;
    return options;
}

TEST(OutlierRemoval, ScatteredNormalsGoAndABlobStays) {
    const auto normals = blobAndScattered();
    const auto pattern = removeOutliers(normals, {});
    const auto kept = keptOf(pattern);
    const auto ofBlob = std::count_if(kept.begin(), kept.end(), [](float i) { return i < kBlob; });
    EXPECT_EQ(static_cast<Eigen::Index>(kept.size()) - ofBlob, 0);
    EXPECT_GT(static_cast<double>(ofBlob), 0.85 * kBlob);  // three rounds of two sigmas
    EXPECT_EQ(pattern.removed + kept.size(), static_cast<std::size_t>(kBlob + kScattered));
    // Each keeps its own direction.
    for (Eigen::Index i = 0; i < pattern.directions.cols(); ++i)
        EXPECT_EQ(pattern.directions.col(i),
                  normals.directions.col(static_cast<Eigen::Index>(pattern.weights[i])));
}

TEST(OutlierRemoval, OneRoundAgreesWithThePlainestWay) {
    const auto normals = blobAndScattered();
    for (const unsigned k : {1U, 10U, 40U, 200U})
        for (const double alpha : {0.5, 2.0}) {
            auto options = rounds(1, k, 7);  // the first number counts if there is one round
            options.alpha = alpha;
            EXPECT_EQ(keptOf(removeOutliers(normals, options)), keptOfOneRound(normals, k, alpha))
                << k << " neighbours, alpha " << alpha;
        }
}

/** The same as removeOutliers(), the plainest way. */
std::vector<float> keptOfRounds(SurfaceNormals normals, const OutlierRemovalOptions& options) {
    const auto all = normals;
    std::vector<float> kept;
    for (unsigned round = 0; round < options.rounds; ++round) {
        kept = keptOfOneRound(normals,
                              static_cast<std::size_t>(std::lround(options.neighboursOf(round))),
                              options.alpha);
        normals.directions.resize(3, static_cast<Eigen::Index>(kept.size()));
        normals.planarity.resize(static_cast<Eigen::Index>(kept.size()));
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const auto column = static_cast<Eigen::Index>(i);
            normals.directions.col(column) = all.directions.col(static_cast<Eigen::Index>(kept[i]));
            normals.planarity[column] = kept[i];
        }
    }
    return kept;
}

TEST(OutlierRemoval, RoundsGoFromTheFirstToTheLastNumber) {
    const auto normals = blobAndScattered();
    EXPECT_EQ(rounds(3, 40, 10).neighboursOf(1), 25);
    // The last ones take so many away that of the nearest ones at first too few are left.
    for (const auto& [first, last, alpha] : {std::tuple(40U, 10U, 2.0), std::tuple(10U, 40U, 2.0),
                                             std::tuple(10U, 10U, 0.0), std::tuple(3U, 3U, 0.0)}) {
        auto options = rounds(3, first, last);
        options.alpha = alpha;
        const auto kept = keptOf(removeOutliers(normals, options));
        EXPECT_EQ(kept, keptOfRounds(normals, options)) << first << " to " << last;
        EXPECT_GT(kept.size(), 10U);
    }
}

TEST(OutlierRemoval, NoRoundRemovesNothing) {
    const auto normals = blobAndScattered();
    const auto pattern = removeOutliers(normals, rounds(0));
    EXPECT_EQ(pattern.directions, normals.directions);
    EXPECT_EQ(pattern.weights, normals.planarity);
    EXPECT_EQ(pattern.removed, 0U);
}

TEST(OutlierRemoval, FewerNormalsThanNeighbours) {
    SurfaceNormals few;
    few.directions.resize(3, 3);
    few.directions << 1, 0, 0, 0, 1, 0, 0, 0, 1;
    few.planarity = Eigen::VectorXf::LinSpaced(3, 0, 2);
    EXPECT_EQ(keptOf(removeOutliers(few, {})).size(), 3U);  // each as far from the others

    SurfaceNormals one;
    one.directions = Eigen::Vector3f(0, 0, 1);
    one.planarity = Eigen::VectorXf::Ones(1);
    EXPECT_EQ(removeOutliers(one, {}).directions.cols(), 1);
}

TEST(OutlierRemoval, IdenticalNormalsAllStay) {
    SurfaceNormals same;
    same.directions = Eigen::Vector3f(0.6F, 0, 0.8F).replicate(1, 200);
    same.planarity = Eigen::VectorXf::Ones(200);
    const auto pattern = removeOutliers(same, {});
    EXPECT_EQ(pattern.directions.cols(), 200);
    EXPECT_EQ(pattern.removed, 0U);
}

TEST(OutlierRemoval, Empty) {
    const auto pattern = removeOutliers({}, {});
    EXPECT_EQ(pattern.directions.cols(), 0);
    EXPECT_EQ(pattern.weights.size(), 0);
}
// Blob and scattered normals, of which a round with alpha 1 always finds some.
TEST(OutlierRemoval, ASmallSetEndsTheRounds) {
    const auto normals = blobAndScattered();
    OutlierRemovalOptions options;
    options.rounds = 30;
    options.alpha = 1;
    const auto all = removeOutliers(normals, options);
    options.small_share = 0.8;
    const auto small = removeOutliers(normals, options);
    EXPECT_LT(small.rounds, all.rounds);
    EXPECT_LE(small.normals, 0.8 * static_cast<double>(normals.directions.cols()));
    EXPECT_GT(small.normals, all.normals);
}

TEST(OutlierRemoval, AStableSetEndsTheRounds) {
    const auto normals = blobAndScattered();
    OutlierRemovalOptions options;
    options.rounds = 30;
    options.alpha = 100;  // nothing is so far from the mean
    EXPECT_EQ(removeOutliers(normals, options).rounds, 30U);
    options.stable_share = 0.01;
    const auto stable = removeOutliers(normals, options);
    EXPECT_EQ(stable.rounds, 1U);
    EXPECT_EQ(stable.removed, 0U);
}

TEST(OutlierRemoval, BothEndsOfTheIntervalTakeMore) {
    auto normals = blobAndScattered();
    normals.directions = normals.directions.leftCols(kBlob).eval();
    normals.planarity = normals.planarity.head(kBlob).eval();
    OutlierRemovalOptions options;
    options.rounds = 1;
    options.alpha = 0.5;
    const auto upper = removeOutliers(normals, options);
    options.both_ends = true;
    EXPECT_LT(removeOutliers(normals, options).normals, upper.normals);
}
}  // namespace
