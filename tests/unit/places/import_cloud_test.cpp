#include "delio/places/stored_map.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iomanip>

#include "delio/core/error.h"
#include "places/map_tracker.h"
#include "places/place_search.h"
#include "town_map.h"

namespace {
using namespace delio;
using namespace delio::localisation_test;
namespace fs = std::filesystem;
using Cloud = std::vector<Eigen::Vector3d>;

/** What a drive round the block saw, as another program would write it. */
Cloud cloudOfTown(const Eigen::Isometry3d& cloudFromTown, const test::Scene& scene = town()) {
    test::Noise noise(5);
    Cloud cloud;
    for (const auto& pose : roundTheBlock(0)) {
        const Eigen::Matrix3Xf seen = seenFrom(scene, pose, noise);
        for (Eigen::Index i = 0; i < seen.cols(); ++i)
            if (seen.col(i).norm() < 60)
                cloud.push_back(cloudFromTown * (pose * seen.col(i).cast<double>()));
    }
    return cloud;
}

void writePly(const Cloud& cloud, const std::string& path) {
    std::ofstream out(path);
    out << "ply\nformat ascii 1.0\nelement vertex " << cloud.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
        << std::setprecision(12);
    for (const auto& point : cloud) out << point.transpose() << "\n";
}

class ImportedTown : public testing::Test {
 protected:
    ImportFigures import(const Cloud& cloud, std::optional<double> spacing = 0.3) const {
        writePly(cloud, ply_);
        return importCloud(ply_, spacing, path_);
    }
    std::string refusalOf(const Cloud& cloud) const {
        try {
            import(cloud);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    /** Where scans from these places of the drive are found, against where they are. */
    void expectFound(const Eigen::Isometry3d& cloudFromTown) const {
        const auto map = std::make_shared<const StoredMap>(path_);
        ASSERT_TRUE(map->cloudOrigin());
        Eigen::Isometry3d mapFromTown = cloudFromTown;
        mapFromTown.translation() -= map->cloudOrigin()->offset;
        const auto poses = roundTheBlock(0);
        test::Noise noise(8);
        for (const std::size_t i : {10U, 33U, 60U, 80U}) {
            MapTracker tracker(map, {}, {});
            MapFix fix;
            for (std::size_t k = i; k < i + 4; ++k)
                fix = tracker.add(
                    {k == i ? Eigen::Isometry3d::Identity() : poses[k - 1].inverse() * poses[k],
                     1e-5 * Matrix6::Identity()},
                    seenFrom(town(), poses[k], noise), Eigen::Vector3d::UnitZ());
            ASSERT_TRUE(isAnchor(fix)) << i << " " << fix.reason;
            EXPECT_LT(test::metresBetween(fix.vehicle.pose, mapFromTown * poses[i + 3]), 0.05) << i;
            EXPECT_LT(test::degreesBetween(fix.vehicle.pose, mapFromTown * poses[i + 3]), 0.5) << i;
        }
    }

    test::TemporaryFolder folder_;
    const std::string ply_ = fileIn(folder_, "cloud.ply"), path_ = fileIn(folder_);
};

TEST_F(ImportedTown, PlacesAreFoundInTheCloudsCoordinates) {
    const auto made = import(cloudOfTown(Eigen::Isometry3d::Identity()));
    EXPECT_TRUE(made.origin.offset.isZero());
    EXPECT_GT(made.places, 10U);
    EXPECT_LT(made.tilt_deg, 0.5);
    expectFound(Eigen::Isometry3d::Identity());
}

TEST_F(ImportedTown, ATiltedCloudInUtmToo) {
    Eigen::Isometry3d utm = test::poseAtDeg(456789.5, 5412345.25, 312, 40, 4, 3);
    const auto made = import(cloudOfTown(utm));
    EXPECT_EQ(made.origin.offset, Eigen::Vector3d(457000, 5412000, 0));
    EXPECT_NEAR(made.tilt_deg, 5, 0.3);
    expectFound(utm);
}

TEST_F(ImportedTown, ASmallCloudKeepsMorePoints) {
    const auto cloud = cloudOfTown(Eigen::Isometry3d::Identity());
    ASSERT_LT(import(cloud, 0.3).kept, 200'000U);
    const auto made = importCloud(ply_, {}, path_);
    EXPECT_EQ(made.points, cloud.size());
    EXPECT_EQ(made.kept, import(cloud, 0.15).kept);
}

TEST_F(ImportedTown, EveryPointIsInOneSubmap) {
    const auto made = import(cloudOfTown(Eigen::Isometry3d::Identity()));
    const StoredMap map(path_);
    ASSERT_EQ(map.submaps().size(), made.submaps);
    EXPECT_EQ(map.cloudOrigin()->tiles, made.submaps);
    EXPECT_TRUE(map.drives().empty());
    std::size_t points = 0;
    for (std::size_t i = 0; i < map.submaps().size(); ++i) {
        points += static_cast<std::size_t>(map.points(i).cols());
        EXPECT_GE(map.surroundings(i).cols(), map.points(i).cols());
        const Eigen::Matrix3Xf there = map.levelFrames()[i].cast<float>() * map.points(i);
        EXPECT_LT((there.row(0).maxCoeff() - there.row(0).minCoeff()), 30.02F);
    }
    EXPECT_EQ(points, made.kept);
}

TEST_F(ImportedTown, WrittenOnceMoreItIsTheSame) {
    import(cloudOfTown(test::poseAtDeg(456789.5, 5412345.25, 312, 40)));
    const std::string again = fileIn(folder_, "again.delio");
    StoredMap::save(StoredMap(path_).content(), again);
    EXPECT_TRUE(test::readText(path_) == test::readText(again));
    import(cloudOfTown(test::poseAtDeg(456789.5, 5412345.25, 312, 40)));
    EXPECT_TRUE(test::readText(path_) == test::readText(again));
}

TEST_F(ImportedTown, StrayPointsAreDropped) {
    auto cloud = cloudOfTown(test::poseAt(456789.5, 5412345.25, 312));
    cloud.insert(cloud.begin(), {0, 0, 0});
    const auto made = import(cloud);
    EXPECT_EQ(made.outliers, 1U);
    EXPECT_EQ(made.origin.offset, Eigen::Vector3d(457000, 5412000, 0));
}

TEST_F(ImportedTown, RefusesAWallAndNothing) {
    Cloud wall;
    for (int i = 0; i < 100; ++i)
        for (int k = 0; k < 100; ++k) wall.emplace_back(0.1 * i, 5, 0.1 * k);
    EXPECT_NE(refusalOf(wall).find("no free ground"), std::string::npos);
    EXPECT_NE(refusalOf({}).find("no finite point"), std::string::npos);
    EXPECT_FALSE(fs::exists(path_));
}

// A point per square, which would take minutes.
TEST_F(ImportedTown, RefusesMillimetres) {
    Cloud cloud;
    for (int i = 0; i < 40; ++i)
        for (int k = 0; k < 40; ++k) cloud.emplace_back(200 * i, 200 * k, 0);
    EXPECT_NE(refusalOf(cloud).find("points per square of 30 m"), std::string::npos);
    EXPECT_FALSE(fs::exists(path_));
}

// The file of drives stays readable by older versions.
TEST_F(ImportedTown, OnlyAnImportedMapHasTheNewVersion) {
    const auto versionOf = [](const std::string& path) { return test::readText(path).at(8); };
    import(cloudOfTown(Eigen::Isometry3d::Identity()));
    EXPECT_EQ(versionOf(path_), 2);
    StoredMap::save(TownDrive(roundTheBlock(0)).content, path_);
    EXPECT_EQ(versionOf(path_), 1);
    EXPECT_FALSE(StoredMap(path_).cloudOrigin());
}
}  // namespace
