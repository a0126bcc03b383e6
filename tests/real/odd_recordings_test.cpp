// Recordings that other programs made, each with something odd about it.
#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "command.h"
#include "delio/core/error.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

class OddRecordings : public testing::Test {
 protected:
    /** A folder with that file of data/odd alone. */
    std::string folderOf(const std::string& name) const {
        fs::copy_file(test::dataFolder() / "odd" / name, folder_ / name);
        return folder_.path();
    }
    test::TemporaryFolder folder_;
};

TEST_F(OddRecordings, LivoxsRawCharacters) {
    DELIO_NEED_DATA("odd/livox_ascii_char_fields.pcd");
    const auto scan = io::openScans(folderOf("livox_ascii_char_fields.pcd"))->next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->points->size(), 43104U);
    EXPECT_TRUE(scan->rings.empty());  // its lines are no rings
}

TEST_F(OddRecordings, WidthAndHeightOfZero) {
    DELIO_NEED_DATA("odd/width_0_height_0.pcd");
    const auto reader = io::openScans(folderOf("width_0_height_0.pcd"));
    const auto scan = reader->next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->points->size(), 14673U);
    EXPECT_EQ(scan->times_s.size(), 14673U);
    // Its points lie at the azimuths that were measured, but its times are up to 1.6 deg off.
    EXPECT_FALSE(reader->recording().motionCompensated);
}

TEST_F(OddRecordings, PointsOf28Bytes) {
    DELIO_NEED_DATA("odd/ouster_28_bytes_a_point.bin");
    const auto reader = io::openScans(folderOf("ouster_28_bytes_a_point.bin"));
    const auto scan = reader->next();
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->points->size(), 4000U);  // two rows, of which the second is cut off
    ASSERT_EQ(scan->times_s.size(), 4000U);
    EXPECT_NEAR(scan->times_s[2047], 0.1, 0.001);
    EXPECT_NE(reader->recording().kind.find("layout pohang"), std::string::npos);
}

TEST_F(OddRecordings, NoReturnsAtTheOriginWithoutTime) {
    DELIO_NEED_DATA("odd/zero_points_without_time.pcd");
    const auto reader = io::openScans(folderOf("zero_points_without_time.pcd"));
    const auto scan = reader->next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->times_s.size(), 240000U);
    float first = 1, last = -1;
    for (std::size_t i = 0; i < scan->times_s.size(); ++i) {
        float x = 0, y = 0, z = 0;
        scan->points->getPoint(i, x, y, z);
        if (x == 0 && y == 0 && z == 0) continue;
        ASSERT_TRUE(std::isfinite(scan->times_s[i])) << i;
        first = std::min(first, scan->times_s[i]);
        last = std::max(last, scan->times_s[i]);
    }
    std::printf("%s; times from %g to %g s\n", describe(reader->recording()).c_str(), first, last);
    EXPECT_GT(last - first, 0.09);
    EXPECT_LT(last - first, 0.11);
    EXPECT_TRUE(reader->recording().compensationMeasured);
}

/** Positions of gt_poses.txt: index, stamp, x y z, qx qy qz qw. */
std::vector<Eigen::Vector3d> truthIn(const fs::path& file) {
    std::ifstream in(file);
    std::vector<Eigen::Vector3d> places;
    for (std::string line; std::getline(in, line);) {
        std::istringstream numbers(line);
        double index = 0, stamp_s = 0;
        Eigen::Vector3d place;
        if (numbers >> index >> stamp_s >> place.x() >> place.y() >> place.z())
            places.push_back(place);
    }
    return places;
}

// Organised by columns, with NaN; compensated by the recorder, which nothing but the points tells.
TEST_F(OddRecordings, ApollosCompensatedScans) {
    DELIO_NEED_DATA("real/apollo_16");
    const auto drive = test::dataFolder() / "real/apollo_16";
    const auto reader = io::openScans((drive / "in_time_order").string());
    EXPECT_TRUE(reader->recording().compensationMeasured);
    EXPECT_EQ(reader->recording().motionCompensated, std::optional<bool>(true));
    const auto run = test::runTool(
        "delio-slam", {"-i", drive / "in_time_order", "-o", folder_ / "out", "--no-map"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    const auto poses = io::readTrajectory(folder_ / "out" / "trajectory_kitti.txt").poses;
    const auto truth = truthIn(drive / "gt_poses.txt");
    ASSERT_EQ(poses.size(), truth.size());
    const double found_m = (poses.back().translation() - poses.front().translation()).norm(),
                 true_m = (truth.back() - truth.front()).norm();
    std::printf("%.3f m, true %.3f m (%+.2f %%)\n", found_m, true_m, 100 * (found_m / true_m - 1));
    EXPECT_NEAR(found_m, true_m, 0.01 * true_m);
}
}  // namespace
