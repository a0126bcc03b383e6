// Rings of real clouds that do not name them.
#include "odometry/rings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "delio/recordings/rawlog_reader.h"
#include "odometry/preprocess.h"
#include "test_data.h"

namespace {
using namespace delio;
using Rings = std::vector<std::uint16_t>;

const std::string kStreet = "real/vlp16_street_first80";

/** A cloud of a file as KITTI has it, without the points on the vehicle. */
Eigen::Matrix3Xf cloudOf(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::vector<float> values;
    float point[4];
    while (in.read(reinterpret_cast<char*>(point), sizeof point))
        if (Eigen::Map<Eigen::Vector3f>(point).norm() > 2.5F)
            values.insert(values.end(), point, point + 3);
    return Eigen::Map<Eigen::Matrix3Xf>(values.data(), 3,
                                        static_cast<Eigen::Index>(values.size() / 3));
}

/** Share of the points that are with most others of their ring of `truth`. */
double purity(const Rings& truth, const Rings& found) {
    std::map<std::uint16_t, std::map<std::uint16_t, std::size_t>> counts;
    for (std::size_t i = 0; i < truth.size(); ++i) ++counts[truth[i]][found[i]];
    std::size_t most = 0;
    for (const auto& [ring, others] : counts)
        most += std::max_element(others.begin(), others.end(), [](const auto& a, const auto& b) {
                    return a.second < b.second;
                })->second;
    return static_cast<double>(most) / static_cast<double>(truth.size());
}

std::vector<Eigen::Index> shuffled(Eigen::Index count) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    return order;
}

TEST(RingsOfRealClouds, VlpInFiringOrder) {
    DELIO_NEED_DATA(kStreet);
    for (const auto* file : {"000000.bin", "000040.bin", "000079.bin"}) {
        const auto points = cloudOf(test::dataFolder() / kStreet / "velodyne" / file);
        const Rings rings = odometry::ringsOf(points);
        for (std::size_t i = 0; i < rings.size(); ++i) {
            const auto p = points.col(static_cast<Eigen::Index>(i));
            ASSERT_NEAR(std::atan2(p.z(), p.head<2>().norm()) * 180 / M_PI, 15 - 2 * rings[i], 0.1)
                << file << ", point " << i;
        }
        EXPECT_EQ(std::set<std::uint16_t>(rings.begin(), rings.end()).size(), 16U);
        const auto order = shuffled(points.cols());
        const Rings ofShuffled = odometry::ringsOf(points(Eigen::all, order));
        for (std::size_t i = 0; i < order.size(); ++i)
            ASSERT_EQ(ofShuffled[i], rings[static_cast<std::size_t>(order[i])]);
    }
}

// MulRan's scans were brought to one stamp, but without moving what one beam gave off its cone.
TEST(RingsOfRealClouds, OusterOfHalfARevolution) {
    DELIO_NEED_DATA("real/os1_kaist03_21");
    const auto folder = test::dataFolder() / "real/os1_kaist03_21/velodyne";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const Rings rings = odometry::ringsOf(cloudOf(entry.path()));
        EXPECT_EQ(std::set<std::uint16_t>(rings.begin(), rings.end()).size(), 64U) << entry.path();
    }
}

// The lower an HDL-64E's beams, the less they meet in one point; not brought to one stamp, 98 % and
// more of a shuffled cloud's points still find their ring.
TEST(RingsOfRealClouds, HdlShuffled) {
    DELIO_NEED_DATA("kitti/drive0005_first60");
    for (const auto* file : {"000000.bin", "000030.bin", "000059.bin"}) {
        const auto points = cloudOf(test::dataFolder() / "kitti/drive0005_first60/velodyne" / file);
        const Rings inOrder = odometry::ringsOf(points);
        EXPECT_EQ(inOrder.back(), 63) << file;
        const auto order = shuffled(points.cols());
        const Rings found = odometry::ringsOf(points(Eigen::all, order));
        Rings truth;
        for (const auto i : order) truth.push_back(inOrder[static_cast<std::size_t>(i)]);
        const double share = purity(truth, found);
        std::printf("%s shuffled: %.4f of the points in their ring\n", file, share);
        EXPECT_GT(share, 0.97) << file;
    }
}

// Packets name the laser of each point.
TEST(RingsOfRealClouds, AreThoseThatPacketsName) {
    DELIO_NEED_DATA("mrpt/test_velodyne_VLP16.rawlog");
    for (const auto* file : {"test_velodyne_VLP16.rawlog", "rot_scan_velodyne.rawlog"}) {
        io::RawlogReader reader((test::dataFolder() / "mrpt" / file).string());
        const auto scan = reader.next();
        ASSERT_TRUE(scan) << file;
        auto cloud = odometry::preprocess(*scan, {});
        ASSERT_FALSE(cloud.rings.empty());
        EXPECT_EQ(odometry::ringsOf(cloud.points), odometry::neighbouringRings(cloud)) << file;
    }
}
}  // namespace
