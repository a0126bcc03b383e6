#include "delio/odometry/aligner.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <tbb/global_control.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <limits>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/slam/options.h"
#include "poses.h"
#include "ring_scan.h"

using namespace delio;

namespace {
using Eigen::Isometry3d;
using mrpt::maps::CPointsMap;
using mrpt::poses::CPose2D;
using mrpt::poses::CPose3D;
using mrpt::poses::CPose3DPDFGaussian;
using mrpt::poses::CPosePDFGaussian;
using mrpt::slam::CMetricMapsAlignmentAlgorithm;
using test::degreesBetween;
using test::metresBetween;
using test::poseAt;

constexpr double kDeg = M_PI / 180;
const Isometry3d kMotion = poseAt(1.5, -0.4, 0.15, 12 * kDeg, -3 * kDeg, 5 * kDeg);

/** What a LiDAR with 2 cm of noise sees of the yard. */
CPointsMap::Ptr seenFrom(const Isometry3d& pose, std::uint32_t seed, const test::Scene& scene) {
    test::Noise noise(seed);
    test::Sensor sensor;
    sensor.noise_m = 0.02;
    return test::scanOf(test::ringScan(scene, pose, sensor, noise).points).points;
}

/** Where the first cloud of a pair is seen from: not along the walls. */
const Isometry3d kFirst = poseAt(0.37, 0.21, 0.13, 17 * kDeg, 2 * kDeg, -3 * kDeg);

/** A pair of clouds, the second moved by `motion` from the first. */
struct Pair {
    explicit Pair(const Isometry3d& motion = kMotion, const test::Scene& scene = test::yard())
        : first(seenFrom(kFirst, 1, scene)), second(seenFrom(kFirst * motion, 2, scene)) {}
    CPointsMap::Ptr first, second;
};

CPose3DPDFGaussian gaussian(const mrpt::poses::CPose3DPDF::Ptr& pdf) {
    const auto* result = dynamic_cast<const CPose3DPDFGaussian*>(pdf.get());
    EXPECT_NE(result, nullptr);
    return result ? *result : CPose3DPDFGaussian();
}

Isometry3d meanOf(const CPose3DPDFGaussian& pdf) { return fromMrpt(pdf.mean); }

TEST(Aligner, FindsAKnownMotionFromManyStarts) {
    const Pair pair;
    test::Noise noise;
    Aligner aligner;
    for (int i = 0; i < 8; ++i) {
        const Isometry3d off =
            poseAt(0.4 * noise.uniform(), 0.4 * noise.uniform(), 0.1 * noise.uniform(),
                   3 * kDeg * noise.uniform(), kDeg * noise.uniform(), kDeg * noise.uniform());
        Aligner::TReturnInfo info;
        const auto found = gaussian(
            aligner.Align3D(pair.first.get(), pair.second.get(), toMrpt(kMotion * off), info));
        EXPECT_LT(metresBetween(meanOf(found), kMotion), 0.01) << i;
        EXPECT_LT(degreesBetween(meanOf(found), kMotion), 0.05) << i;
        EXPECT_GT(info.goodness, 0.8);
        EXPECT_LE(info.goodness, 1);
        EXPECT_GT(info.agreement, aligner.options.min_agreement);
        EXPECT_GT(info.quality, 0);
        EXPECT_GT(info.matches, 500U);
        EXPECT_GT(info.nIterations, 2U);
        EXPECT_LT(info.residual_m, 0.05);
        EXPECT_GT(info.executionTime, 0);
        EXPECT_FALSE(info.searched);
    }
}

TEST(Aligner, SearchesWhereTheEstimateIsFarOff) {
    const Pair pair;
    Aligner aligner;
    Aligner::TReturnInfo info;
    const auto found = gaussian(aligner.Align3D(pair.first.get(), pair.second.get(),
                                                toMrpt(poseAt(6, 4, 0, -10 * kDeg)), info));
    EXPECT_TRUE(info.searched);
    EXPECT_LT(metresBetween(meanOf(found), kMotion), 0.01);
    EXPECT_LT(degreesBetween(meanOf(found), kMotion), 0.05);
}

/** As a program would that knows nothing but the base class. */
Isometry3d aligned(CMetricMapsAlignmentAlgorithm& algorithm, const Pair& pair,
                   const Isometry3d& start, mrpt::slam::CICP::TReturnInfo& info) {
    return fromMrpt(
        algorithm.Align3D(pair.first.get(), pair.second.get(), toMrpt(start), info)->getMeanVal());
}

TEST(Aligner, IsNearerToTheTruthThanCICPInTheSameProgram) {
    const Pair pair;
    mrpt::slam::CICP icp;
    icp.options.thresholdDist = 1;
    icp.options.thresholdAng = 3 * kDeg;
    icp.options.maxIterations = 200;
    Aligner aligner;
    for (const auto& off : {poseAt(0, 0, 0), poseAt(0.3, -0.2, 0, 2 * kDeg)}) {
        mrpt::slam::CICP::TReturnInfo icpInfo, info;
        const Isometry3d byIcp = aligned(icp, pair, kMotion * off, icpInfo);
        const Isometry3d byAligner = aligned(aligner, pair, kMotion * off, info);
        EXPECT_LT(metresBetween(byAligner, kMotion), metresBetween(byIcp, kMotion) / 2);
        EXPECT_LT(degreesBetween(byAligner, kMotion), degreesBetween(byIcp, kMotion) / 2);
        EXPECT_GT(info.goodness, 0.8);
        EXPECT_GT(info.executionTime, 0);
    }
}

/** The paper's registration. */
PaperAligner paperAligner() { return PaperAligner(Options::ofProfile("paper").paper); }

TEST(PaperAligner, IsNearerToTheTruthThanCICPInTheSameProgram) {
    const Pair pair;
    mrpt::slam::CICP icp;
    icp.options.thresholdDist = 1;
    icp.options.thresholdAng = 3 * kDeg;
    icp.options.maxIterations = 200;
    PaperAligner aligner = paperAligner();
    for (const auto& off : {poseAt(0, 0, 0), poseAt(0.3, -0.2, 0, 2 * kDeg)}) {
        mrpt::slam::CICP::TReturnInfo icpInfo, info;
        const Isometry3d byIcp = aligned(icp, pair, kMotion * off, icpInfo);
        const Isometry3d byPaper = aligned(aligner, pair, kMotion * off, info);
        EXPECT_LT(metresBetween(byPaper, kMotion), metresBetween(byIcp, kMotion));
        EXPECT_LT(degreesBetween(byPaper, kMotion), degreesBetween(byIcp, kMotion) / 2);
        EXPECT_GT(info.goodness, 0.5);
        EXPECT_LE(info.goodness, 1);
        EXPECT_GT(info.nIterations, 2U);
        EXPECT_GT(info.executionTime, 0);
    }
}

TEST(PaperAligner, RefusesWhatItCannotAlign) {
    const Pair pair;
    PaperAligner aligner = paperAligner();
    mrpt::maps::CSimplePointsMap three;
    for (int i = 0; i < 3; ++i) three.insertPoint(10.0F, static_cast<float>(i), 0);
    const auto why = [&](const mrpt::maps::CMetricMap* first,
                         const mrpt::maps::CMetricMap* second) {
        try {
            aligner.Align3D(first, second, CPose3D());
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_NE(why(nullptr, pair.second.get()).find("no first map"), std::string::npos);
    EXPECT_NE(why(pair.first.get(), &three).find("too few"), std::string::npos)
        << why(pair.first.get(), &three);
}

TEST(Aligner, GivesThePoseInThePlaneFor2D) {
    const CPose2D motion(1.2, -0.5, 8 * kDeg);
    const Pair pair{fromMrpt(CPose3D(motion))};
    Aligner aligner;
    const auto pdf = aligner.Align(pair.first.get(), pair.second.get(), CPose2D(1, -0.3, 6 * kDeg));
    const auto* found = dynamic_cast<const CPosePDFGaussian*>(pdf.get());
    ASSERT_NE(found, nullptr);
    EXPECT_NEAR(found->mean.x(), motion.x(), 0.01);
    EXPECT_NEAR(found->mean.y(), motion.y(), 0.01);
    EXPECT_NEAR(found->mean.phi(), motion.phi(), 0.05 * kDeg);
    const auto in3D = gaussian(
        aligner.Align3D(pair.first.get(), pair.second.get(), CPose3D(CPose2D(1, -0.3, 6 * kDeg))));
    const int kept[] = {0, 1, 3};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(found->cov(r, c), in3D.cov(kept[r], kept[c]));
}

// That the covariance is of the pose's numbers x y z yaw pitch roll, PosePdf tests; here, that it
// has the size of the errors.
TEST(Aligner, CovarianceHasTheSizeOfTheErrors) {
    constexpr int kRuns = 12;
    double rotation = 0, translation = 0;
    Aligner aligner;
    for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
        const auto first = seenFrom(kFirst, 10 + 2 * seed, test::yard());
        const auto second = seenFrom(kFirst * kMotion, 11 + 2 * seed, test::yard());
        const auto found = gaussian(aligner.Align3D(first.get(), second.get(), toMrpt(kMotion)));
        const auto& m = found.mean;
        const CPose3D truth = toMrpt(kMotion);
        const Eigen::Vector3d t = meanOf(found).translation() - kMotion.translation();
        const Eigen::Vector3d angles(m.yaw() - truth.yaw(), m.pitch() - truth.pitch(),
                                     m.roll() - truth.roll());
        const Matrix6 C = found.cov.asEigen();
        ASSERT_EQ(C.llt().info(), Eigen::Success);
        translation += t.dot(C.topLeftCorner<3, 3>().llt().solve(t));
        rotation += angles.dot(C.bottomRightCorner<3, 3>().llt().solve(angles));
    }
    // 3 expected; standard deviations within a factor of three.
    EXPECT_GT(translation / kRuns, 3. / 9);
    EXPECT_LT(translation / kRuns, 3 * 9);
    EXPECT_GT(rotation / kRuns, 3. / 9);
    EXPECT_LT(rotation / kRuns, 3 * 9);
}

TEST(Aligner, FindsWallsThatLieOnTheBordersBetweenVoxels) {
    // The yard's walls are at whole metres, and so in the first cloud.
    const auto first = seenFrom(Isometry3d::Identity(), 1, test::yard());
    const auto second = seenFrom(kMotion, 2, test::yard());
    Aligner aligner;
    const auto found = gaussian(aligner.Align3D(first.get(), second.get(), toMrpt(kMotion)));
    EXPECT_LT(metresBetween(meanOf(found), kMotion), 0.005);
    EXPECT_LT(degreesBetween(meanOf(found), kMotion), 0.02);
}

TEST(Aligner, AlongACorridorTheEstimateStaysAndTheCovarianceSaysSo) {
    const Isometry3d motion = poseAt(1, 0.2, 0.05, 3 * kDeg);
    const Pair pair(motion, test::corridor());
    Aligner aligner;
    Aligner::TReturnInfo info;
    // The corridor's axis in the first cloud's frame.
    const Eigen::Vector3d along = kFirst.linear().row(0).transpose();
    const Eigen::Vector3d off = -0.4 * along;
    const auto found =
        gaussian(aligner.Align3D(pair.first.get(), pair.second.get(),
                                 toMrpt(poseAt(off.x(), off.y(), off.z()) * motion), info));
    ASSERT_EQ(info.unobservedTranslation.cols(), 1);
    EXPECT_NEAR(std::abs(along.dot(info.unobservedTranslation.col(0))), 1, 1e-2);
    EXPECT_LT(info.quality, 1e-3);
    const Eigen::Vector3d error = meanOf(found).translation() - motion.translation();
    EXPECT_NEAR(error.dot(along), -0.4, 0.05);
    EXPECT_LT((error - error.dot(along) * along).norm(), 0.01);
    const Eigen::Matrix3d C = found.cov.asEigen().topLeftCorner<3, 3>();
    EXPECT_GT(along.dot(C * along), 0.2);
}

TEST(Aligner, SameBytesWithOneAndTwoThreads) {
    const Pair pair;
    const auto run = [&](std::size_t threads, const Isometry3d& start) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return gaussian(Aligner().Align3D(pair.first.get(), pair.second.get(), toMrpt(start)));
    };
    for (const auto& start : {kMotion, poseAt(6, 4, 0, -10 * kDeg)}) {
        const auto one = run(1, start), two = run(2, start);
        EXPECT_EQ(one.mean.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>(),
                  two.mean.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>());
        EXPECT_EQ(one.cov, two.cov);
    }
}

TEST(Aligner, PassesOverPointsThatAreNotFiniteAndTakesAnyMapOfPoints) {
    const Pair pair;
    auto second = mrpt::maps::CPointsMapXYZI::Create();
    second->insertAnotherMap(pair.second.get(), CPose3D());
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    for (int i = 0; i < 100; ++i) second->insertPointFast(kNaN, 1, 1);
    Aligner aligner;
    const auto found = gaussian(aligner.Align3D(pair.first.get(), second.get(), toMrpt(kMotion)));
    EXPECT_LT(metresBetween(meanOf(found), kMotion), 0.01);
    EXPECT_TRUE(found.cov.asEigen().allFinite());
}

void expectError(const std::string& part, const std::function<void()>& act) {
    try {
        act();
        FAIL() << "no error that says: " << part;
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
}

TEST(Aligner, RefusesWhatItCannotAlign) {
    const Pair pair;
    Aligner aligner;
    const auto align = [&](const mrpt::maps::CMetricMap* first,
                           const mrpt::maps::CMetricMap* second,
                           const Isometry3d& start = kMotion) {
        return [&aligner, first, second, start] { aligner.Align3D(first, second, toMrpt(start)); };
    };
    const CPointsMap* first = pair.first.get();
    const CPointsMap* second = pair.second.get();
    expectError("there is no first map", align(nullptr, second));
    expectError("there is no second map", align(first, nullptr));

    const mrpt::maps::COccupancyGridMap2D grid;
    expectError("the first map is a ", align(&grid, second));
    expectError("COccupancyGridMap2D; only maps of points", align(first, &grid));

    const mrpt::maps::CSimplePointsMap empty;
    expectError("the first map has no finite points", align(&empty, second));
    expectError("the second map has no finite points", align(first, &empty));

    mrpt::maps::CSimplePointsMap ring, few;
    for (int i = 0; i < 1000; ++i)
        ring.insertPoint(static_cast<float>(10 * std::cos(i * 2 * M_PI / 1000)),
                         static_cast<float>(10 * std::sin(i * 2 * M_PI / 1000)), 0);
    expectError("the first map has no planes, of 1000 points", align(&ring, second));
    for (int i = 0; i < 30; ++i) few.insertPoint(static_cast<float>(i), 0, 0);
    expectError("the second map has too few points: 30 ", align(first, &few));

    expectError("within 10 m of the initial estimate fewer than 100 points",
                align(first, second, poseAt(1000, 0, 0)));
    expectError("the initial estimate is not finite",
                align(first, second, poseAt(std::nan(""), 0, 0)));
    expectError("the first map is a ", [&] { aligner.Align(&grid, second, CPose2D(0, 0, 0)); });
}

TEST(AlignerOptions, AreLoadedFromTheSectionsThatAProgramNames) {
    mrpt::config::CConfigFileMemory config(
        "[my]\nscan_spacing = 0.7\n[my.plane_map]\nvoxel_size = 0.8\n"
        "[my.plane_registration]\nsearch_radius = 3\n[other]\nx = 1\n");
    AlignerOptions options;
    options.loadFromConfigFile(config, "my");
    EXPECT_EQ(options.scan_spacing, 0.7);
    EXPECT_EQ(options.planeMap.voxel_size, 0.8);
    EXPECT_EQ(options.planes.search_radius, 3);
    EXPECT_EQ(options.map_spacing, AlignerOptions().map_spacing);

    mrpt::config::CConfigFileMemory saved;
    options.saveToConfigFile(saved, "a");
    AlignerOptions again;
    again.loadFromConfigFile(saved, "a");
    EXPECT_EQ(again.scan_spacing, 0.7);
    EXPECT_EQ(again.planeMap.voxel_size, 0.8);

    const auto load = [](const std::string& text) {
        return [text] {
            AlignerOptions o;
            o.loadFromConfigFile(mrpt::config::CConfigFileMemory(text), "a");
        };
    };
    expectError("option a.spacing does not exist", load("[a]\nspacing = 1\n"));
    expectError("option a.plane_map.voxel does not exist", load("[a.plane_map]\nvoxel = 1\n"));
    expectError("options section [a.planemap] does not exist", load("[a.planemap]\nvoxel = 1\n"));
}
}  // namespace
