// delio::Aligner where a program would use mrpt::slam::CICP, on real scans.
#include "delio/odometry/aligner.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <cstdio>
#include <string>

#include "delio/core/geometry.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/trajectory.h"
#include "odometry/preprocess.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::maps::CPointsMap;
using mrpt::poses::CPose3D;

/** A scan of an HDL-64E with its vertical angles corrected. */
CPointsMap::Ptr loadScan(const std::filesystem::path& file) {
    auto raw = mrpt::maps::CPointsMapXYZI::Create();
    EXPECT_TRUE(raw->loadFromKittiVelodyneFile(file.string()));
    Scan scan;
    scan.points = raw;
    PreprocessOptions options;
    options.vertical_correction_deg = 0.205;
    const auto corrected = odometry::preprocess(scan, options).points;
    auto points = mrpt::maps::CSimplePointsMap::Create();
    for (Eigen::Index i = 0; i < corrected.cols(); ++i)
        points->insertPointFast(corrected(0, i), corrected(1, i), corrected(2, i));
    return points;
}

/** Error against the reference poses of aligning scan `second` to scan `first`, from the identity:
 *  metres and degrees. */
std::pair<double, double> errorOf(mrpt::slam::CMetricMapsAlignmentAlgorithm& algorithm,
                                  const std::filesystem::path& folder, std::size_t first,
                                  std::size_t second) {
    const auto name = [](std::size_t scan) {
        return std::string(scan < 10 ? "00000" : "0000") + std::to_string(scan) + ".bin";
    };
    const auto poses =
        io::lidarToCam0(io::readTrajectory((folder / "poses.txt").string()),
                        io::readCalibration((folder / "calib.txt").string()).Tr.inverse())
            .poses;
    const auto a = loadScan(folder / "velodyne" / name(first));
    const auto b = loadScan(folder / "velodyne" / name(second));
    const Eigen::Isometry3d found =
        fromMrpt(algorithm.Align3D(a.get(), b.get(), CPose3D())->getMeanVal());
    const Eigen::Isometry3d truth = poses[first].inverse() * poses[second];
    const Eigen::Isometry3d off = truth.inverse() * found;
    const double metres = off.translation().norm();
    const double degrees = evaluation::rotationAngle_rad(off) * 180 / M_PI;
    std::printf("scan %zu to %zu: %.3f m, %.3f deg\n", second, first, metres, degrees);
    return {metres, degrees};
}

// The references are good to about 1 % of the way.
TEST(AlignerOnRealScans, AlignsScansMetresApartFromTheIdentity) {
    DELIO_NEED_DATA("kitti/00_first16");
    const auto folder = test::dataFolder() / "kitti" / "00_first16";
    Aligner aligner;
    mrpt::slam::CICP icp;
    icp.options.thresholdDist = 3;
    icp.options.maxIterations = 200;
    const auto near = errorOf(aligner, folder, 0, 3);  // 2.2 m
    EXPECT_LT(near.first, 0.05);
    EXPECT_LT(near.second, 0.15);
    // An independent witness, given wide thresholds.
    EXPECT_LT(near.first, errorOf(icp, folder, 0, 3).first + 0.01);
    const auto far = errorOf(aligner, folder, 0, 10);  // 7.5 m: this is searched for
    EXPECT_LT(far.first, 0.1);
    EXPECT_LT(far.second, 0.25);
}
}  // namespace
