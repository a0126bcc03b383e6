#include "recordings/point_table.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "delio/core/error.h"

namespace delio::io {
namespace {
constexpr std::size_t kPoints = 400;
constexpr double kStamp_s = 1700000000.5;

/** Records of x y z (float), then what a test adds. */
struct Records {
    PointLayout layout{{{"x", 0, NumberKind::kFloat32},
                        {"y", 4, NumberKind::kFloat32},
                        {"z", 8, NumberKind::kFloat32}},
                       12,
                       false};
    std::vector<std::vector<std::uint8_t>> points;

    Records() {
        for (std::size_t i = 0; i < kPoints; ++i) {
            points.emplace_back();
            for (const double value : {1.0 + static_cast<double>(i), 2.0, 3.0})
                append(points.back(), static_cast<float>(value));
        }
    }

    template <typename Value>
    void append(std::vector<std::uint8_t>& to, Value value) const {
        std::uint8_t bytes[sizeof(value)];
        std::memcpy(bytes, &value, sizeof(value));
        if (layout.bigEndian) std::reverse(bytes, bytes + sizeof(value));
        to.insert(to.end(), bytes, bytes + sizeof(value));
    }

    /** `valueOf(share)`: share of the turn, 0 to 1. */
    template <typename Value, typename ValueOf>
    void add(const std::string& name, NumberKind kind, const ValueOf& valueOf) {
        layout.fields.push_back({name, layout.step, kind});
        for (std::size_t i = 0; i < kPoints; ++i)
            append(points[i], static_cast<Value>(valueOf(static_cast<double>(i) / (kPoints - 1))));
        layout.step += sizeof(Value);
    }

    Scan scan(PointTable& table, std::size_t rows = 1) const {
        std::vector<std::uint8_t> bytes;
        for (const auto& point : points) bytes.insert(bytes.end(), point.begin(), point.end());
        return table.scan(layout, bytes.data(), bytes.size(), points.size(), rows, {kStamp_s, 0});
    }
    Scan scan() const {
        PointTable table;
        return scan(table);
    }
};

void expectTurn(const Scan& scan, double from_s, double tolerance_s = 1e-6) {
    ASSERT_EQ(scan.times_s.size(), kPoints);
    for (std::size_t i = 0; i < kPoints; ++i)
        ASSERT_NEAR(scan.times_s[i], from_s + 0.1 * static_cast<double>(i) / (kPoints - 1),
                    tolerance_s);
}
}  // namespace

TEST(PointTable, NothingIsNoPoints) {
    PointTable table;
    EXPECT_EQ(table.scan(Records().layout, nullptr, 0, 0, 1, {kStamp_s, 0}).points->size(), 0U);
}

TEST(PointTable, CoordinatesIntensityAndRings) {
    Records records;
    records.add<std::uint8_t>("intensity", NumberKind::kUint8, [](double) { return 51; });
    records.add<std::uint16_t>("ring", NumberKind::kUint16,
                               [](double share) { return std::floor(16 * share); });
    const Scan scan = records.scan();
    ASSERT_EQ(scan.points->size(), kPoints);
    float x = 0, y = 0, z = 0;
    scan.points->getPoint(7, x, y, z);
    EXPECT_EQ(x, 8);
    EXPECT_EQ(y, 2);
    EXPECT_EQ(z, 3);
    const auto& bright = dynamic_cast<const mrpt::maps::CPointsMapXYZI&>(*scan.points);
    EXPECT_FLOAT_EQ(bright.getPointIntensity(3), 0.2F);
    EXPECT_EQ(scan.rings.front(), 0);
    EXPECT_EQ(scan.rings.back(), 16);
    EXPECT_TRUE(scan.times_s.empty());
    EXPECT_EQ(scan.stamp_s, kStamp_s);
}

TEST(PointTable, RowsOfAnOrganisedCloudAreRings) {
    PointTable table;
    EXPECT_EQ(Records().scan(table, 16).rings.at(kPoints - 1), 15);
    // Columns where there are fewer of them, as Apollo writes its scans.
    const auto columns = Records().scan(table, 50).rings;
    EXPECT_EQ(columns.at(7), 7);
    EXPECT_EQ(columns.at(8), 0);
    EXPECT_TRUE(Records().scan(table, 1).rings.empty());
    EXPECT_TRUE(Records().scan(table, 7).rings.empty());
}

TEST(PointTable, TimesFromTheStampInAnyUnit) {
    const auto turn = [](double unit) { return [=](double share) { return 0.1 * share / unit; }; };
    Records s, ms, us, ns, before;
    s.add<float>("time", NumberKind::kFloat32, turn(1));
    ms.add<float>("timestamp", NumberKind::kFloat32, turn(1e-3));
    us.add<std::uint32_t>("offset_time", NumberKind::kUint32, turn(1e-6));
    ns.add<std::uint32_t>("t", NumberKind::kUint32, turn(1e-9));
    before.add<float>("time", NumberKind::kFloat32, [](double share) { return 0.1 * share - 0.1; });
    expectTurn(s.scan(), 0);
    expectTurn(ms.scan(), 0);
    expectTurn(us.scan(), 0, 2e-6);
    expectTurn(ns.scan(), 0);
    expectTurn(before.scan(), -0.1);
}

TEST(PointTable, UnixTimesAndClocksOfTheirOwn) {
    Records unix_s, unix_ns, own;
    unix_s.add<double>("timestamp", NumberKind::kFloat64,
                       [](double share) { return kStamp_s - 0.05 + 0.1 * share; });
    unix_ns.add<double>("t", NumberKind::kFloat64,
                        [](double share) { return 1e9 * (kStamp_s + 0.1 * share); });
    own.add<double>("timestamp", NumberKind::kFloat64,
                    [](double share) { return 5432.1 + 0.1 * share; });
    expectTurn(unix_s.scan(), -0.05);
    expectTurn(unix_ns.scan(), 0, 2e-6);
    expectTurn(own.scan(), 0);
}

TEST(PointTable, TimesThatTellNothing) {
    Records zero, wild;
    zero.add<float>("time", NumberKind::kFloat32, [](double) { return 0; });
    EXPECT_TRUE(zero.scan().times_s.empty());
    // The unit is kept: what then is of no turn has no times.
    PointTable table;
    Records good;
    good.add<float>("time", NumberKind::kFloat32, [](double share) { return 0.1 * share; });
    expectTurn(good.scan(table), 0);
    wild.add<float>("time", NumberKind::kFloat32, [](double share) { return 900 * share; });
    EXPECT_TRUE(wild.scan(table).times_s.empty());
    Records holes;
    holes.add<float>("time", NumberKind::kFloat32,
                     [](double share) { return share > 0.5 ? NAN : 0.1 * share; });
    const auto times = holes.scan().times_s;
    EXPECT_TRUE(std::isnan(times.back()));
    EXPECT_EQ(times.front(), 0);
}

// What a driver writes where there was no return must not decide on the clock.
TEST(PointTable, PointsWithoutCoordinatesDoNotCount) {
    const std::vector<double> nothings{0, NAN};
    for (const double nothing : nothings) {
        Records records;
        records.add<double>("timestamp", NumberKind::kFloat64, [&](double share) {
            const auto i = static_cast<int>(std::lround(share * (kPoints - 1)));
            return i % 3 == 1 ? nothing : kStamp_s + 0.1 * share;
        });
        for (std::size_t i = 1; i < kPoints; i += 3)
            for (std::size_t at = 0; at < 12; at += 4) {
                const float origin = i % 2 == 0 ? 0.0F : NAN;
                std::memcpy(&records.points[i][at], &origin, sizeof(origin));
            }
        PointTable table;
        const auto times = records.scan(table).times_s;
        ASSERT_EQ(times.size(), kPoints);
        EXPECT_NEAR(times.back(), 0.1, 1e-6);
        EXPECT_TRUE(std::isnan(times[1]));
        EXPECT_TRUE(table.findings().empty());
    }
}

TEST(PointTable, BigEndian) {
    Records records;
    const Scan little = records.scan();
    Records big;
    big.layout.bigEndian = true;
    for (auto& point : big.points)
        for (std::size_t i = 0; i < point.size(); i += 4)
            std::reverse(point.begin() + static_cast<std::ptrdiff_t>(i),
                         point.begin() + static_cast<std::ptrdiff_t>(i + 4));
    const Scan scan = big.scan();
    EXPECT_EQ(scan.points->getPointsBufferRef_x(), little.points->getPointsBufferRef_x());
}

TEST(PointTable, RefusesWhatCannotBeRead) {
    Records missing, outside, unknown;
    missing.layout.fields.erase(missing.layout.fields.begin() + 1);
    EXPECT_THROW(missing.scan(), Error);
    outside.layout.fields.push_back({"time", 10, NumberKind::kFloat32});
    EXPECT_THROW(outside.scan(), Error);
    unknown.layout.fields.push_back({"time", 0, static_cast<NumberKind>(9)});
    EXPECT_THROW(unknown.scan(), Error);
    const Records records;
    PointTable table;
    const std::vector<std::uint8_t> bytes(24);
    EXPECT_THROW(table.scan(records.layout, bytes.data(), bytes.size(), 3, 1, {}), Error);
    EXPECT_THROW(table.scan(records.layout, bytes.data(), bytes.size(), SIZE_MAX, 1, {}), Error);
    EXPECT_EQ(table.scan(records.layout, bytes.data(), bytes.size(), 2, 1, {}).points->size(), 2U);
}
}  // namespace delio::io
