// The same scan in each layout of .bin files.
#include "formats/bin_layouts.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cmath>

#include "cloud_files.h"
#include "recordings/cloud_folder.h"

namespace {
using namespace delio;
using namespace delio::cloud_test;
using test::writeText;

struct Point {
    float x, y, z, intensity;  //!< 0 to 1
    std::uint16_t ring;
    float time_s;  //!< since the turn began
};

constexpr std::size_t kRows = 64, kColumns = 1024;

/** A turn between walls 8 m away and above a floor 2 m below, column by column; upper rows first.
 *  The sky gives no return. */
std::vector<Point> turn(int scan) {
    std::vector<Point> points;
    for (std::size_t column = 0; column < kColumns; ++column)
        for (std::size_t row = 0; row < kRows; ++row) {
            const double turned = -2 * M_PI * static_cast<double>(column) / kColumns;
            const double up = (16.6 - 0.527 * static_cast<double>(row)) * M_PI / 180;
            const double wall =
                (8 + 0.1 * scan) / std::max(std::abs(std::cos(turned)), std::abs(std::sin(turned)));
            const double flat = up < 0 ? std::min(wall, -2 / std::tan(up)) : wall;
            const double range = row < 4 ? 0 : flat / std::cos(up);
            points.push_back({static_cast<float>(range * std::cos(up) * std::cos(turned)),
                              static_cast<float>(range * std::cos(up) * std::sin(turned)),
                              static_cast<float>(range * std::sin(up)),
                              static_cast<float>(row % 4) / 4, static_cast<std::uint16_t>(row),
                              static_cast<float>(0.1 * static_cast<double>(column) / kColumns)});
        }
    return points;
}

std::uint8_t byteOf(float zeroToOne) {
    return static_cast<std::uint8_t>(std::lround(255 * zeroToOne));
}

std::string recordOf(const std::string& layout, const Point& p) {
    const std::string xyz = raw(p.x, p.y, p.z), xyzi = xyz + raw(p.intensity);
    const auto ns = static_cast<std::uint32_t>(std::lround(1e9 * double{p.time_s}));
    const std::uint16_t none = 0, seven = 7;
    if (layout == "kitti" || layout == "mulran") return xyzi;
    if (layout == "nuscenes") return xyzi + raw(static_cast<float>(p.ring));
    if (layout == "boreas") return xyzi + raw(static_cast<float>(p.ring), p.time_s - 0.05F);
    if (layout == "helipr-ouster") return xyzi + raw(ns, seven, p.ring, none);
    if (layout == "helipr-velodyne") return xyzi + raw(p.ring, p.time_s);
    if (layout == "pohang") return xyzi + raw(ns, seven, none, std::uint32_t{7});
    if (layout == "helipr-avia")
        return xyz + raw(byteOf(p.intensity), std::uint8_t{16},
                         static_cast<std::uint8_t>(p.ring % 6), ns);
    if (layout == "helipr-aeva" || layout == "helipr-aeva-intensity")
        return xyzi + raw(-3.5F, static_cast<std::int32_t>(ns), static_cast<std::uint8_t>(p.ring)) +
               (layout == "helipr-aeva" ? "" : raw(p.intensity));
    if (layout == "nclt") {  // x forward, y right, z down
        const auto cm = [](float metres) {
            return static_cast<std::uint16_t>(std::lround((double{metres} + 100) / 0.005));
        };
        return raw(cm(p.x), cm(-p.y), cm(-p.z), byteOf(p.intensity),
                   static_cast<std::uint8_t>(p.ring));
    }
    ADD_FAILURE() << "no writer for " << layout;
    return "";
}

std::string bytesOf(const std::string& layout, const std::vector<Point>& points) {
    std::string bytes;
    for (const Point& point : points) bytes += recordOf(layout, point);
    return bytes;
}

/** Row by row, as Pohang's are. */
std::vector<Point> byRows(std::vector<Point> points) {
    std::stable_sort(points.begin(), points.end(),
                     [](const Point& one, const Point& other) { return one.ring < other.ring; });
    return points;
}

void expectScan(const Scan& scan, const std::vector<Point>& points, const std::string& layout) {
    const bool timed = layout != "kitti" && layout != "nuscenes" && layout != "nclt";
    const bool ringed =
        layout != "kitti" && layout.find("av") == layout.npos && layout.find("aeva") == layout.npos;
    const float tolerance_m = layout == "nclt" ? 0.0026F : 1e-6F;
    ASSERT_EQ(scan.points->size(), points.size());
    ASSERT_EQ(scan.times_s.size(), timed ? points.size() : 0U);
    ASSERT_EQ(scan.rings.size(), ringed ? points.size() : 0U);
    const auto read = pointsOf(scan);
    // Boreas' times count from the middle of the turn.
    const float begin_s = layout == "boreas" ? -0.05F : 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_NEAR(read[i][0], points[i].x, tolerance_m) << i;
        ASSERT_NEAR(read[i][1], points[i].y, tolerance_m) << i;
        ASSERT_NEAR(read[i][2], points[i].z, tolerance_m) << i;
        ASSERT_NEAR(read[i][3], points[i].intensity, 0.003F) << i;
        if (timed) {
            ASSERT_NEAR(scan.times_s[i], points[i].time_s + begin_s, 2e-6F) << i;
        }
        if (ringed) {
            ASSERT_EQ(scan.rings[i], points[i].ring) << i;
        }
    }
}

/** As a sensor of the layout has it. */
std::vector<Point> turnOf(const std::string& layout, int scan) {
    auto points = turn(scan);
    if (layout == "pohang") return byRows(points);
    // 65536 points, column by column, are MulRan's.
    if (layout == "kitti") points.resize(points.size() - 1);
    // NCLT's sensor has 32 rows.
    if (layout == "nclt")
        points.erase(std::remove_if(points.begin(), points.end(),
                                    [](const Point& point) { return point.ring >= 32; }),
                     points.end());
    return points;
}

class BinLayouts : public testing::Test {
 protected:
    void SetUp() override { fs::create_directories(scans_); }
    void write(const std::string& layout) const {
        for (int scan = 0; scan < 3; ++scan)
            writeText(scans_ / (std::to_string(1600000000 + scan) + ".bin"),
                      bytesOf(layout, turnOf(layout, scan)));
    }
    test::TemporaryFolder folder_;
    const fs::path scans_ = folder_ / "scans";
};

TEST_F(BinLayouts, EachIsRecognised) {
    for (const io::BinLayout& layout : io::binLayouts()) {
        const std::string name = layout.name;
        SCOPED_TRACE(name);
        write(name);
        for (const std::string& chosen : {std::string(), name}) {
            io::CloudFolder reader(scans_, chosen);
            for (int i = 0; i < 3; ++i) {
                const auto scan = reader.next();
                ASSERT_TRUE(scan);
                expectScan(*scan, turnOf(name, i), name);
                EXPECT_EQ(scan->stamp_s, 1600000000 + i);
            }
            EXPECT_EQ(reader.recording().kind,
                      "folder of .bin files" + (name == "kitti" ? "" : ", layout " + name));
        }
    }
}

TEST_F(BinLayouts, ABrokenScanOfMulranHasNoTimes) {
    write("mulran");
    auto points = turn(1);
    points.resize(60000);
    writeText(scans_ / "1600000001.bin", bytesOf("mulran", points));
    io::CloudFolder reader(scans_);
    EXPECT_EQ(reader.next()->times_s.size(), kRows * kColumns);
    EXPECT_TRUE(reader.next()->times_s.empty());
    EXPECT_EQ(reader.next()->times_s.size(), kRows * kColumns);
}

/** As many points as MulRan's, but in another order. */
TEST_F(BinLayouts, RowsOf65536PointsAreNotMulrans) {
    const std::string bytes = bytesOf("kitti", byRows(turn(0)));
    const std::vector<std::uint8_t> scan(bytes.begin(), bytes.end());
    const auto found = io::binLayoutsOf(scan);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_STREQ(found[0]->name, "kitti");
}

TEST_F(BinLayouts, AnotherOneIsRefusedInOneLine) {
    const auto error = [&](const std::string& layout = "") {
        return errorOf([&] {
            io::CloudFolder reader(scans_, layout);
            while (reader.next()) {
            }
        });
    };
    write("boreas");
    expectError(error("velodyne"), {"no layout 'velodyne'", "boreas", "nclt", "pohang"});
    expectError(error("helipr-velodyne"), {"1600000000.bin", "multiple of 22"});
    writeText(scans_ / "1600000002.bin", bytesOf("nclt", {turn(0)[100]}));
    expectError(error(), {"1600000002.bin", "layout boreas", "multiple of 24"});
    // As many bytes as 48 points of nuScenes' and 40 of Boreas', with rings and times for both.
    std::string both;
    for (int i = 0; i < 240; ++i) {
        const bool isTime = i % 6 == 5, isRing = i % 5 == 4;
        both += raw(isTime ? (isRing ? 0.0F : 0.1F) : static_cast<float>(i / 6 % 3));
    }
    writeText(scans_ / "1600000000.bin", both);
    expectError(error(), {"fits the layouts nuscenes and boreas", "--sensor-label"});
    writeText(scans_ / "1600000001.bin", both);
    writeText(scans_ / "1600000002.bin", both);
    EXPECT_EQ(error("boreas"), "");
}
}  // namespace
