#include "delio/map/cloud_files.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "delio/core/error.h"
#include "delio/earth/georeference.h"
#include "delio/recordings/scan_reader.h"
#include "formats/las.h"
#include "point_support.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::somePoints;

std::string messageOf(const std::string& path) {
    try {
        map::loadLas(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

template <typename Number>
Number at(const std::string& bytes, std::size_t offset) {
    Number value;
    std::memcpy(&value, bytes.data() + offset, sizeof(value));
    return value;
}

template <typename Number>
std::string with(std::string bytes, std::size_t offset, Number value) {
    std::memcpy(bytes.data() + offset, &value, sizeof(value));
    return bytes;
}

TEST(Las, GivesThePointsBack) {
    const test::TemporaryFolder folder;
    for (const std::size_t count : {0, 1, 4096, 10000}) {
        auto points = somePoints(count);
        for (auto& point : points) point.time_s = std::abs(point.time_s);
        if (count > 0) points[0].time_s = 0;
        map::saveLas(points, folder / "map.las");
        const auto las = map::loadLas(folder / "map.las");
        EXPECT_TRUE(las.offset.isZero());
        EXPECT_EQ(las.wkt, "");
        ASSERT_EQ(las.points.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto &a = las.points[i], &b = points[i];
            ASSERT_LT((a.position - b.position).cwiseAbs().maxCoeff(), 0.0004F) << i;  // floats
            ASSERT_EQ(a.normal, b.normal);
            ASSERT_EQ(a.observations, b.observations);
            ASSERT_EQ(a.residual_m, b.residual_m);
            ASSERT_EQ(a.time_s, b.time_s);
            ASSERT_NEAR(a.intensity, b.intensity * 65535, 0.51);
        }
    }
}

TEST(Las, IsLaidOutAsTheSpecificationSays) {
    const test::TemporaryFolder folder;
    auto points = somePoints(3);
    points[1].intensity = 0.5F;
    map::LasPlace place;
    place.wkt = earth::wktOf({32, true});
    place.firstScan_unix_s = 1317046450.5;  // 2011: 15 leap seconds since 1980
    place.coordinatesOf = [](const Eigen::Vector3d& p) -> Eigen::Vector3d {
        return p + Eigen::Vector3d(456789, 5430123, 112);
    };
    map::saveLas(points, folder / "map.las", place);
    const std::string bytes = test::readText(folder / "map.las");
    EXPECT_EQ(bytes.substr(0, 4), "LASF");
    EXPECT_EQ(at<std::uint16_t>(bytes, 6), 17);  // standard GPS time, WKT
    EXPECT_EQ(bytes[24], 1);
    EXPECT_EQ(bytes[25], 4);
    EXPECT_EQ(at<std::uint16_t>(bytes, 94), 375);
    EXPECT_EQ(at<std::uint32_t>(bytes, 100), 2U);
    EXPECT_EQ(bytes[104], 6);
    const std::size_t record = at<std::uint16_t>(bytes, 105), from = at<std::uint32_t>(bytes, 96);
    EXPECT_EQ(record, 30U + 2 + 4 * 4);
    EXPECT_EQ(at<std::uint32_t>(bytes, 107), 0U);  // legacy
    EXPECT_EQ(at<std::uint64_t>(bytes, 247), 3U);
    EXPECT_EQ(at<std::uint64_t>(bytes, 255), 3U);
    EXPECT_EQ(bytes.size(), from + 3 * record);
    EXPECT_EQ(bytes.substr(375 + 2, 9), "LASF_Spec");
    EXPECT_EQ(at<std::uint16_t>(bytes, 375 + 18), 4);
    EXPECT_EQ(at<std::uint16_t>(bytes, 375 + 20), 5 * 192);
    EXPECT_EQ(bytes[375 + 54 + 2], 3);  // unsigned short
    EXPECT_EQ(bytes.substr(375 + 54 + 4, 12), "observations");
    const std::size_t wkt = 375 + 54 + 5 * 192;
    EXPECT_EQ(bytes.substr(wkt + 2, 15), "LASF_Projection");
    EXPECT_EQ(at<std::uint16_t>(bytes, wkt + 18), 2112);
    EXPECT_EQ(bytes.substr(wkt + 54, place.wkt.size() + 1), place.wkt + '\0');
    const std::size_t second = from + record;
    const Eigen::Vector3d truth = place.coordinatesOf(points[1].position.cast<double>());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value =
            at<std::int32_t>(bytes, second + 4 * axis) * at<double>(bytes, 131 + 8 * axis) +
            at<double>(bytes, 155 + 8 * axis);
        EXPECT_NEAR(value, truth[static_cast<Eigen::Index>(axis)], 0.6e-4);
        EXPECT_LE(at<double>(bytes, 187 + 16 * axis), value + 1e-8);  // min
        EXPECT_GE(at<double>(bytes, 179 + 16 * axis), value - 1e-8);  // max
    }
    EXPECT_EQ(at<std::uint16_t>(bytes, second + 12), 32768);
    EXPECT_EQ(bytes[second + 14], 0x11);
    EXPECT_NEAR(at<double>(bytes, second + 22),
                1317046450.5 + double{points[1].time_s} - 315964800 + 15 - 1e9, 1e-6);
    EXPECT_EQ(at<std::uint16_t>(bytes, second + 30), points[1].observations);
    const auto las = map::loadLas(folder / "map.las");
    EXPECT_EQ(las.wkt, place.wkt);
    EXPECT_LT((las.points[1].position.cast<double>() + las.offset - truth).norm(), 1e-3);
}

TEST(Las, MarksTheGround) {
    const test::TemporaryFolder folder;
    map::MapPoints points;
    for (int x = 0; x < 100; ++x)
        for (int y = 0; y < 100; ++y) points.push_back(test::pointAt(0.2 * x, 0.2 * y, -1.7));
    const std::size_t ground = points.size();
    for (int z = 0; z < 100; ++z) points.push_back(test::pointAt(5, 5, -1.2 + 0.05 * z));
    map::saveLas(points, folder / "map.las");
    io::LasReader las(folder / "map.las");
    std::size_t i = 0;
    las.forEach([&](const std::uint8_t* record) { ASSERT_EQ(record[16], i++ < ground ? 2 : 1); });
}

TEST(Las, RefusesDamagedFiles) {
    const test::TemporaryFolder folder;
    map::saveLas(somePoints(100), folder / "whole.las");
    const std::string whole = test::readText(folder / "whole.las");
    const std::size_t from = at<std::uint32_t>(whole, 96);
    const auto expect = [&](const std::string& bytes, const std::string& words) {
        test::writeText(folder / "bad.las", bytes);
        const auto message = messageOf(folder / "bad.las");
        EXPECT_NE(message.find("bad.las"), message.npos) << words << ": " << message;
        EXPECT_NE(message.find(words), message.npos) << message;
    };
    EXPECT_NE(messageOf(folder / "none.las"), "");
    expect("", "header");
    expect("hello", "header");
    expect(whole.substr(0, 226), "header");
    expect(whole.substr(0, 300), "sizes");
    expect(whole.substr(0, 400), "sizes");
    expect(whole.substr(0, from), "0 of 100");
    expect(whole.substr(0, whole.size() - 1), "99 of 100");
    expect(with<std::uint8_t>(whole, 25, 9), "version");
    expect(with<std::uint8_t>(whole, 104, 0x86), "LAZ");
    expect(with<std::uint8_t>(whole, 104, 11), "format 11");
    expect(with<std::uint16_t>(whole, 105, 0), "of 0 bytes");
    expect(with<std::uint16_t>(whole, 105, 29), "of 29 bytes");
    expect(with<std::uint16_t>(whole, 94, 100), "sizes");
    expect(with<std::uint16_t>(whole, 94, 65535), "sizes");
    expect(with<std::uint32_t>(whole, 96, 0xffffffff), "sizes");
    expect(with<std::uint32_t>(whole, 96, 100), "sizes");
    expect(with<std::uint32_t>(whole, 100, 0xffffffff), "variable records");
    expect(with<std::uint16_t>(whole, 375 + 20, 65535), "variable records");
    expect(with<std::uint64_t>(whole, 247, 101), "100 of 101");
    expect(with<std::uint64_t>(whole, 247, std::numeric_limits<std::uint64_t>::max()), "100 of");
    expect(with<double>(whole, 131, std::nan("")), "scale");
    expect(with<double>(whole, 131, 0), "scale");
    expect(with<double>(whole, 163, 1e300), "scale");
    // Extras that are not known are skipped.
    test::writeText(folder / "odd.las", with<std::uint8_t>(whole, 375 + 54 + 2, 77));
    EXPECT_EQ(map::loadLas(folder / "odd.las").points.size(), 100U);
}

TEST(Las, IsAScanInAFolder) {
    const test::TemporaryFolder folder;
    io::LasFile file;
    file.extras = {{"ring", io::NumberKind::kUint16, ""}};
    for (const char* name : {"1.las", "2.las"})
        io::saveLas(
            file, 1000,
            [](std::size_t i, io::LasPoint& point) {
                const double angle = static_cast<double>(i) * 0.006;
                point.position = {10 * std::cos(angle), 10 * std::sin(angle), 1};
                point.intensity = 77;
                point.time_s = 100 + static_cast<double>(i) * 1e-4;
                point.extras = {static_cast<double>(i % 16)};
            },
            folder / name);
    const auto reader = io::openScans((folder / "").string());
    const auto scan = reader->next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 1000U);
    EXPECT_EQ(scan->rings.at(17), 1);
    EXPECT_NEAR(scan->times_s.at(999) - scan->times_s.at(0), 0.0999, 1e-6);
    EXPECT_EQ(scan->points->getPointsBufferRef_x()[0], 10);
    EXPECT_TRUE(reader->next());
    EXPECT_FALSE(reader->next());
    test::writeText(folder / "2.las", "cut");
    EXPECT_THROW(
        {
            const auto again = io::openScans((folder / "").string());
            while (again->next()) continue;
        },
        Error);
}
}  // namespace
