/** Maps of the real scans, as pictures: streets have to be seen in them. */
#include <gtest/gtest.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <fstream>

#include "command.h"
#include "delio/formats/trajectory.h"
#include "delio/map/cloud_files.h"
#include "delio/map/map_builder.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "delio/run/run_folder.h"
#include "test_data.h"

namespace {
using Eigen::Isometry3d;
namespace map = delio::map;
namespace picture = delio::picture;

mrpt::maps::CPointsMapXYZI readScan(const std::filesystem::path& path) {
    mrpt::maps::CPointsMapXYZI points;
    std::ifstream in(path, std::ios::binary);
    float p[4];
    while (in.read(reinterpret_cast<char*>(p), sizeof(p)))
        points.insertPointRGB(p[0], p[1], p[2], p[3], 0, 0);
    return points;
}

struct Drive {
    map::MapBuilder builder{map::MapOptions()};
    std::vector<Isometry3d> poses;
};

Drive readDrive(const std::string& name) {
    const auto folder = delio::test::dataFolder() / "kitti" / name;
    const auto calibration = delio::io::readCalibration((folder / "calib.txt").string());
    Drive drive;
    const Isometry3d toLidar = calibration.Tr.inverse();
    for (const auto& cam0 : delio::io::readTrajectory((folder / "poses.txt").string()).poses)
        drive.poses.push_back(toLidar * cam0 * calibration.Tr);
    std::vector<std::filesystem::path> scans;
    for (const auto& file : std::filesystem::directory_iterator(folder / "velodyne"))
        scans.push_back(file.path());
    std::sort(scans.begin(), scans.end());
    for (std::size_t i = 0; i < scans.size(); ++i)
        drive.builder.add(i, drive.poses.at(i), readScan(scans[i]), Isometry3d::Identity(),
                          mrpt::Clock::fromDouble(1e9 + 0.1 * static_cast<double>(i)));
    return drive;
}

/** Share of the pixels that differ from the background, and in how many colours. */
struct Coverage {
    double share = 0;
    std::size_t colours = 0;
};

Coverage coverageOf(const mrpt::img::CImage& image) {
    std::vector<unsigned> values;
    std::size_t covered = 0;
    for (int row = 0; row < static_cast<int>(image.getHeight()); ++row)
        for (int column = 0; column < static_cast<int>(image.getWidth()); ++column) {
            const auto* bgr =
                image.ptr<std::uint8_t>(static_cast<unsigned>(column), static_cast<unsigned>(row));
            values.push_back(unsigned{bgr[0]} | unsigned{bgr[1]} << 8 | unsigned{bgr[2]} << 16);
            covered += bgr[0] > 60 || bgr[1] > 60 || bgr[2] > 60;
        }
    std::sort(values.begin(), values.end());
    const auto end = std::unique(values.begin(), values.end());
    return {
        static_cast<double>(covered) / static_cast<double>(image.getWidth() * image.getHeight()),
        static_cast<std::size_t>(end - values.begin())};
}

void expectAPictureOfStreets(const std::string& name, std::size_t minKeyframes) {
    const Drive drive = readDrive(name);
    EXPECT_GE(drive.builder.keyframes(), minKeyframes);
    const auto points = map::cloudOf(drive.builder.build(drive.poses).points);
    EXPECT_GT(points.size(), 50000U);
    const auto scene = picture::mapScene(points, {drive.poses, {}, {}, {}});
    const auto coverage = coverageOf(picture::picture(*scene, {}));
    EXPECT_GT(coverage.share, 0.1);
    EXPECT_GT(coverage.colours, 1000U);
    // For looking at: DELIO_PICTURES=FOLDER keeps the pictures.
    if (const char* folder = std::getenv("DELIO_PICTURES")) {
        const std::string stem = std::string(folder) + "/" + name;
        picture::saveScene(*scene, stem + ".3Dscene");
        picture::savePicture(*scene, {}, stem + "_map.png");
        picture::savePicture(*scene, picture::topView(), stem + "_top.png");
        const auto way = picture::trajectoryScene({drive.poses, {}, {}, {}});
        picture::savePicture(*way, picture::topView(), stem + "_trajectory.png");
    }
}

TEST(RealMap, First16OfKitti00) {
    DELIO_NEED_DATA("kitti/00_first16");
    expectAPictureOfStreets("00_first16", 5);
}

TEST(RealMap, First60OfDrive0005) {
    DELIO_NEED_DATA("kitti/drive0005_first60");
    expectAPictureOfStreets("drive0005_first60", 10);
}
/** Points in the corridor that was driven through, from 0.3 to 2 m above the road. */
std::size_t inTheWay(const map::MapPoints& points, const std::vector<Isometry3d>& poses) {
    constexpr double kSensor_m = 1.73, kHalfWidth_m = 1.2;
    return static_cast<std::size_t>(
        std::count_if(points.begin(), points.end(), [&](const map::MapPoint& point) {
            return std::any_of(poses.begin(), poses.end(), [&](const Isometry3d& pose) {
                const Eigen::Vector3d p = pose.inverse() * point.position.cast<double>();
                const double height = p.z() + kSensor_m;
                return std::abs(p.x()) < 0.5 && std::abs(p.y()) < kHalfWidth_m && height > 0.3 &&
                       height < 2;
            });
        }));
}

double medianResidual(const map::MapPoints& points) {
    std::vector<float> residuals;
    for (const auto& point : points)
        if (point.normal.norm() > 0) residuals.push_back(point.residual_m);
    const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
    std::nth_element(residuals.begin(), middle, residuals.end());
    return double{*middle};
}

// A van drives ahead, a cyclist beside it.
TEST(RealMap, WhatDroveAheadLeavesNoTrail) {
    DELIO_NEED_DATA("kitti/drive0005_first60");
    const delio::test::TemporaryFolder folder;
    const std::string rawlog = folder / "d.rawlog";
    const auto sequence = delio::test::dataFolder() / "kitti/drive0005_first60";
    ASSERT_EQ(delio::test::runTool("kitti2rawlog", {"-i", sequence, "-o", rawlog}).exitCode, 0);
    const auto slam = [&](const std::string& out, const std::string& setting) {
        const auto run = delio::test::runTool("delio-slam",
                                              {"-i", rawlog, "-o", folder / out, "--set", setting});
        EXPECT_EQ(run.exitCode, 0) << run.err;
        return delio::run::RunFolder(folder / out);
    };
    const auto clean = slam("clean", "removal.enabled=true");
    const auto all = slam("all", "removal.enabled=false");
    const auto cleanPoints = map::loadPly(clean.path(delio::run::RunFolder::kPly));
    const auto allPoints = map::loadPly(all.path(delio::run::RunFolder::kPly));
    const auto poses = clean.trajectory().poses;
    const auto left = inTheWay(cleanPoints, poses), before = inTheWay(allPoints, poses);
    std::printf("in the way: %zu of %zu points; residual %.4f of %.4f m\n", left, before,
                medianResidual(cleanPoints), medianResidual(allPoints));
    ASSERT_GT(before, 1000U);
    EXPECT_LT(double(left), 0.02 * double(before));
    EXPECT_LE(medianResidual(cleanPoints), medianResidual(allPoints));
    EXPECT_GT(cleanPoints.size(), 0.85 * double(allPoints.size()));
}
}  // namespace
