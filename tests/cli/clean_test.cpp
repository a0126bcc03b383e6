#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "command.h"
#include "delio/map/cloud_files.h"
#include "poses.h"
#include "ring_scan.h"
#include "test_data.h"

// delio-map --clean
namespace {
using namespace delio;
using test::runTool;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr std::size_t kScans = 16;
const Eigen::Isometry3d kWorldFromStreet = test::poseAtDeg(100, 50, 3, 10, 1, 0);

/** Of the sensor, in the street. */
Eigen::Isometry3d sensorAt(std::size_t i) {
    return test::poseAt(0.5 * static_cast<double>(i), 0, 0);
}

/** A van that overtakes. */
test::Block vanAt(std::size_t i) {
    const double x = -4 + 1.4 * static_cast<double>(i);
    return {{x, 2, -1.7}, {x + 3, 4, 0.2}};
}

bool isOnVan(const Eigen::Vector3f& inStreet) {
    const Eigen::AlignedBox3f way(Eigen::Vector3f(-4.1F, 1.9F, -1.6F),
                                  Eigen::Vector3f(21, 4.1F, 0.3F));
    return way.contains(inStreet);
}

class CleanFolder : public testing::Test {
 protected:
    CleanFolder() { fs::create_directory(scans_); }

    static std::string viewpointOf(const Eigen::Isometry3d& pose) {
        const Eigen::Quaterniond q(pose.linear());
        std::ostringstream text;
        text << std::setprecision(12) << "VIEWPOINT " << pose.translation().transpose() << " "
             << q.w() << " " << q.x() << " " << q.y() << " " << q.z() << "\n";
        return text.str();
    }
    void write(const std::string& name, const std::string& viewpoint,
               const Eigen::Matrix3Xf& points) const {
        std::ofstream out(fs::path(scans_) / name);
        out << "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH "
            << points.cols() << "\nHEIGHT 1\n"
            << viewpoint << "POINTS " << points.cols() << "\nDATA binary\n";
        out.write(reinterpret_cast<const char*>(points.data()), 12 * points.cols());
    }
    /** Numbers of points off the van and on it. */
    struct Counts {
        std::size_t still = 0, van = 0;
        void add(const Eigen::Vector3f& inWorld) {
            const Eigen::Vector3d at = kWorldFromStreet.inverse() * inWorld.cast<double>();
            ++(isOnVan(at.cast<float>()) ? van : still);
        }
    };
    Counts writeStreet() const {
        Counts counts;
        test::Noise noise;
        for (std::size_t i = 0; i < kScans; ++i) {
            auto street = test::yard();
            street.push_back(vanAt(i));
            const Eigen::Isometry3d sensor = kWorldFromStreet * sensorAt(i);
            const auto seen = ringScan(street, sensorAt(i), {48, 900, -24, 8, 0.01}, noise).points;
            const Eigen::Matrix3Xf points = (sensor * seen.cast<double>()).cast<float>();
            for (Eigen::Index k = 0; k < points.cols(); ++k) counts.add(points.col(k));
            write(std::string(1, static_cast<char>('a' + i)) + ".pcd", viewpointOf(sensor), points);
        }
        return counts;
    }
    test::CommandResult clean(const Words& more = {}) const {
        Words words{"--clean", scans_, "-o", out_};
        words.insert(words.end(), more.begin(), more.end());
        return runTool("delio-map", words);
    }
    void expectRefusal(const test::CommandResult& run, int exitCode,
                       const std::string& text) const {
        EXPECT_EQ(run.exitCode, exitCode) << run.err;
        EXPECT_TRUE(test::isOneLine(run.err)) << run.err;
        EXPECT_NE(run.err.find(text), std::string::npos) << run.err;
        EXPECT_FALSE(fs::exists(out_));
    }

    const test::TemporaryFolder folder_;
    const std::string scans_ = folder_ / "scans", out_ = folder_ / "clean.pcd";
};

TEST_F(CleanFolder, LosesTheVanAndKeepsTheStreet) {
    const Counts before = writeStreet();
    const auto run = clean({"--verbose"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("dynamic points"), std::string::npos) << run.err;
    Counts after;
    for (const auto& point : map::loadPcd(out_)) after.add(point.position);
    EXPECT_GT(before.van, 3000U);
    EXPECT_LT(after.van, before.van / 20);
    EXPECT_GT(after.still, before.still - before.still / 50);
    EXPECT_LE(after.still, before.still);
}

TEST_F(CleanFolder, NeedsScans) {
    expectRefusal(clean(), 1, "no .pcd file in folder '" + scans_ + "'");
    expectRefusal(runTool("delio-map", {"--clean", folder_ / "nothing", "-o", out_}), 1,
                  "cannot read folder");
    expectRefusal(clean({"-i", scans_}), 2, "give either -i, --clean or --import");
}

TEST_F(CleanFolder, NeedsThePosesOfTheSensor) {
    const Eigen::Matrix3Xf points = 9 * Eigen::Matrix3Xf::Random(3, 100);
    write("a.pcd", "", points);
    expectRefusal(clean(), 1, "a.pcd': its VIEWPOINT is missing");
    write("a.pcd", "VIEWPOINT 1 2 3 1 0 0\n", points);
    expectRefusal(clean(), 1, "its VIEWPOINT is not seven numbers");
    write("a.pcd", "VIEWPOINT 1 2 3 1 0 0 1\n", points);
    expectRefusal(clean(), 1, "is not a unit quaternion");
    write("a.pcd", "VIEWPOINT 0 0 0 1 0 0 0\n", points);
    write("b.pcd", "VIEWPOINT 0 0 0 1 0 0 0\n", points);
    expectRefusal(clean(), 1, "have the same VIEWPOINT");
}

TEST_F(CleanFolder, NeverWritesOverAScan) {
    writeStreet();
    const auto before = test::readText(scans_ + "/a.pcd");
    const auto run = runTool("delio-map", {"--clean", scans_, "-o", scans_ + "/a.pcd", "--force"});
    EXPECT_NE(run.exitCode, 0);
    EXPECT_TRUE(test::isOneLine(run.err)) << run.err;
    EXPECT_EQ(test::readText(scans_ + "/a.pcd"), before);
}
}  // namespace
