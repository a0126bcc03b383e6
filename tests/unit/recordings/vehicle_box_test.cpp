// Points of the own vehicle.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "delio/core/geometry.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;

/** Points of scan `scan`: x = scan, y = 0, 1, 2, ... 49, z = -1.5, seen from the roof. */
class VehicleBox : public testing::Test {
 protected:
    void SetUp() override {
        std::vector<mrpt::serialization::CSerializable::Ptr> objects;
        for (int scan = 0; scan < 3; ++scan) objects.push_back(cloudObservation(scan));
        writeRawlog(rawlog_, objects);
        const auto images = std::filesystem::path(io::sidecarPath(rawlog_, "_Images"));
        std::filesystem::create_directory(images);
        std::vector<float> times;
        for (int i = 0; i < 50; ++i) times.push_back(0.001F * static_cast<float>(i));
        writeValues(images / "000000.time", times);
    }
    std::unique_ptr<io::ScanReader> open(const Eigen::AlignedBox3d& box) const {
        return open(std::vector<io::VehiclePart>{{box, 0, 0, 0, 0, 1, "", "the vehicle box"}});
    }
    std::unique_ptr<io::ScanReader> open(const std::vector<io::VehiclePart>& parts) const {
        io::ScanSource source{rawlog_, "", "", ""};
        source.vehicle = parts;
        return io::openScans(source);
    }
    /** A file with these lines. */
    std::string mask(const std::string& lines) const {
        test::writeText(folder_ / "mask.txt", lines);
        return folder_ / "mask.txt";
    }
    /** y of the points that a file with these lines leaves out of scan `scan`. */
    std::vector<int> withoutLines(const std::string& lines, int scan = 0) const {
        const auto reader = open(io::vehiclePartsIn(mask(lines)));
        for (int i = 0; i < scan; ++i) reader->next();
        std::set<int> gone;
        for (int y = 0; y < 50; ++y) gone.insert(y);
        const auto read = reader->next();
        for (const float y : read->points->getPointsBufferRef_y()) gone.erase(static_cast<int>(y));
        return {gone.begin(), gone.end()};
    }
    std::string faultOf(const std::string& text) const {
        try {
            io::vehiclePartsIn(text);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    test::TemporaryFolder folder_;
    std::string rawlog_ = folder_ / "d.rawlog";
};

TEST_F(VehicleBox, IsInTheVehiclesFrame) {
    const Eigen::Vector3d tenth = fromMrpt(kOnTheRoof) * Eigen::Vector3d(0, 10, -1.5);
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.3);
    const auto reader = open({tenth - half, tenth + half});
    const auto first = reader->next(), second = reader->next();
    ASSERT_EQ(first->points->size(), 49U);
    EXPECT_EQ(first->points->getPointsBufferRef_y()[9], 9);
    EXPECT_EQ(first->points->getPointsBufferRef_y()[10], 11);
    ASSERT_EQ(first->times_s.size(), 49U);
    EXPECT_FLOAT_EQ(first->times_s[10], 0.011F);
    EXPECT_EQ(second->points->size(), 50U);
    EXPECT_TRUE(reader->recording().findings.empty());
}

TEST_F(VehicleBox, WithoutPointsIsDoubted) {
    const auto reader = open({Eigen::Vector3d(500, 0, 0), Eigen::Vector3d(501, 1, 1)});
    while (const auto scan = reader->next()) EXPECT_EQ(scan->points->size(), 50U);
    ASSERT_EQ(reader->recording().findings.size(), 1U);
    EXPECT_NE(reader->recording().findings[0].find("vehicle box"), std::string::npos);
}
// Points of scan 0 are at azimuth 90 deg, the first one straight below; those of scan 1 are at
// atan2(y, 1); elevations are atan2(-1.5, y).
TEST_F(VehicleBox, ASectorIsSeenFromTheSensor) {
    using Ys = std::vector<int>;
    EXPECT_EQ(withoutLines("sector 85 95 -9 -8\n"), Ys{10});
    EXPECT_EQ(withoutLines("sector 85 95 -9 -8\n", 1), Ys{});
    EXPECT_EQ(withoutLines("sector 84 95 -9 -8\n", 1), Ys{10});
    EXPECT_EQ(withoutLines("sector 89 91 -9 0 13.1 # ends behind y = 13\n"), (Ys{10, 11, 12, 13}));
    EXPECT_EQ(withoutLines("sector 95 85 -90 90\n"), Ys{0});
    EXPECT_EQ(withoutLines("sector 270 100 -9 -8\n"), Ys{10});
    EXPECT_EQ(withoutLines("sector -275 -265 -9 -8\n"), Ys{10});
    EXPECT_EQ(withoutLines("sector 100 440 -9 -8\n"), Ys{});
    EXPECT_EQ(withoutLines("sector 100 460 -9 -8\n"), Ys{10});
}

TEST_F(VehicleBox, AFileHasBoxesAndSectors) {
    const auto tenth = fromMrpt(kOnTheRoof) * Eigen::Vector3d(0, 10, -1.5);
    std::string lines = "# the mast\n\nbox";
    for (const double to : {-0.3, 0.3})
        for (const double value : tenth) lines += " " + std::to_string(value + to);
    EXPECT_EQ(withoutLines(lines + "\nsector 85 95 -4.6 -4.5\n"), (std::vector<int>{10, 19}));
    const auto reader = open(io::vehiclePartsIn(mask(lines + "\nsector 85 95 10 20\n")));
    while (reader->next()) continue;
    ASSERT_EQ(reader->recording().findings.size(), 1U);
    EXPECT_EQ(reader->recording().findings[0], "no point of any scan lies in '" +
                                                   std::string(folder_ / "mask.txt") +
                                                   "', line 4: it is given in degrees, in the "
                                                   "sensor's frame");
}

TEST_F(VehicleBox, ASectorMayBeOneSensors) {
    std::vector<mrpt::serialization::CSerializable::Ptr> objects;
    for (int scan = 0; scan < 3; ++scan)
        for (const char* label : {"front", "back"})
            objects.push_back(cloudObservation(scan, label));
    std::filesystem::remove_all(std::filesystem::path(io::sidecarPath(rawlog_, "_Images")));
    writeRawlog(rawlog_, objects);
    io::ScanSource source{rawlog_, "front,back", "", ""};
    for (const auto& [sensor, left] : std::map<std::string, std::size_t>{{"", 98}, {"back", 99}}) {
        source.vehicle = io::vehiclePartsIn(mask("sector 0 360 -9 -8 99 " + sensor));
        const auto reader = io::openScans(source);
        EXPECT_EQ(reader->next()->points->size(), left) << sensor;
    }
    source.label = "front";
    const auto front = io::openScans(source);
    while (const auto scan = front->next()) EXPECT_EQ(scan->points->size(), 50U);
    ASSERT_EQ(front->recording().findings.size(), 1U);
}

TEST_F(VehicleBox, ABadLineIsNamed) {
    for (const std::string line :
         {"box 1 2 3 4 5", "box 1 2 3 4 5 nan", "box 4 0 0 1 1 1", "sphere 1 2 3", "sector 1 2 3",
          "sector 1 2 4 3", "sector 1 2 3 x", "sector 1 2 3 4 0", "sector 1 2 3 4 5 a b"}) {
        const std::string fault = faultOf(mask("# parts\n" + line + "\n"));
        EXPECT_NE(fault.find("mask.txt', line 2: expected "), std::string::npos) << fault;
        EXPECT_EQ(fault.find('\n'), std::string::npos);
    }
    EXPECT_NE(faultOf(mask("# nothing\n")).find("has no box and no sector"), std::string::npos);
    for (const std::string text : {"1,2,3,4,5", "4,0,0,1,1,1", "no-such-file", ""})
        EXPECT_NE(faultOf(text).find("--vehicle-box needs XMIN"), std::string::npos) << text;
    EXPECT_EQ(faultOf("0,0,0,1,1,1"), "");
}
}  // namespace
