#include "recordings/turn_assembler.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>
#include <memory>
#include <vector>

#include "delio/core/error.h"

namespace {
using namespace delio;
using namespace delio::io;

/** Gives scans from a list; throws after them, if wanted. */
class ListReader : public ScanReader {
 public:
    explicit ListReader(std::vector<Scan> scans, bool isDamaged = false)
        : scans_(std::move(scans)), isDamaged_(isDamaged) {}
    std::optional<Scan> next() override {
        if (next_ == scans_.size() && isDamaged_) throw Error("cut off");
        if (next_ == scans_.size()) return {};
        return scans_[next_++];
    }
    bool skip() override { return next().has_value(); }
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return others_; }
    std::optional<double> fraction() const override {
        return static_cast<double>(next_) / static_cast<double>(scans_.size());
    }
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override { return {}; }

 private:
    std::vector<Scan> scans_;
    bool isDamaged_;
    std::size_t next_ = 0;
    std::string label_ = "lidar";
    std::set<std::string> others_;
    std::optional<DriveMeta> meta_;
};

/** Points on a circle from one azimuth to another (deg), with times from the stamp on. */
Scan partOf(std::size_t index, double from_deg, double to_deg, double stamp_s) {
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    Scan scan;
    scan.index = index;
    scan.stamp_s = stamp_s;
    for (double azimuth = from_deg; azimuth < to_deg; azimuth += 0.5) {
        const double rad = azimuth * M_PI / 180;
        points->insertPoint(static_cast<float>(10 * std::cos(rad)),
                            static_cast<float>(10 * std::sin(rad)), 0);
        points->setPointIntensity(points->size() - 1, static_cast<float>(stamp_s));
        scan.rings.push_back(static_cast<std::uint16_t>(index));
        scan.times_s.push_back(static_cast<float>((azimuth - from_deg) / 3600));
    }
    scan.points = points;
    return scan;
}

/** Each turn in `parts` messages, from -180 deg on. */
std::vector<Scan> partsOfTurns(int turns, int parts) {
    std::vector<Scan> scans;
    const double width_deg = 360.0 / parts;
    for (int i = 0; i < turns * parts; ++i) {
        const double from_deg = -180 + width_deg * (i % parts);
        scans.push_back(
            partOf(static_cast<std::size_t>(i), from_deg, from_deg + width_deg, 0.1 / parts * i));
    }
    return scans;
}

std::vector<Scan> allOf(ScanReader& reader) {
    std::vector<Scan> scans;
    while (auto scan = reader.next()) scans.push_back(std::move(*scan));
    return scans;
}

TEST(TurnAssembler, PartsBecomeTurns) {
    for (const int parts : {2, 3, 4, 8}) {
        TurnAssembler reader(std::make_unique<ListReader>(partsOfTurns(5, parts)));
        const auto turns = allOf(reader);
        ASSERT_EQ(turns.size(), 5U) << parts;
        for (std::size_t i = 0; i < turns.size(); ++i) {
            EXPECT_EQ(turns[i].index, i);
            EXPECT_NEAR(turns[i].stamp_s, 0.1 * static_cast<double>(i), 1e-9);
            ASSERT_EQ(turns[i].points->size(), 720U);
            ASSERT_EQ(turns[i].rings.size(), 720U);
            ASSERT_EQ(turns[i].times_s.size(), 720U);
            EXPECT_NEAR(turns[i].times_s.back(), 0.1, 1e-3);  // from the turn's stamp
            const auto& points = dynamic_cast<mrpt::maps::CPointsMapXYZI&>(*turns[i].points);
            EXPECT_NEAR(points.getPointIntensity(719), turns[i].stamp_s + 0.1 - 0.1 / parts, 1e-5);
        }
        EXPECT_FALSE(reader.recording().findings.empty());
    }
}

TEST(TurnAssembler, AMissingPartDoesNotJoinTwoTurns) {
    auto parts = partsOfTurns(5, 2);
    parts.erase(parts.begin() + 5);  // the second half of the third turn
    TurnAssembler reader(std::make_unique<ListReader>(parts));
    const auto turns = allOf(reader);
    ASSERT_EQ(turns.size(), 5U);
    EXPECT_EQ(turns[2].points->size(), 360U);
    EXPECT_EQ(turns[3].points->size(), 720U);
}

TEST(TurnAssembler, WholeTurnsAndOneSidedSensorsStayAsTheyAre) {
    std::vector<Scan> whole, ahead;
    for (std::size_t i = 0; i < 10; ++i) {
        whole.push_back(partOf(i, -180, 180, 0.1 * static_cast<double>(i)));
        ahead.push_back(partOf(i, -60, 60, 0.1 * static_cast<double>(i)));
    }
    for (const auto& scans : {whole, ahead}) {
        TurnAssembler reader(std::make_unique<ListReader>(scans));
        EXPECT_TRUE(reader.skip());
        const auto read = allOf(reader);
        ASSERT_EQ(read.size(), 9U);
        EXPECT_EQ(read.front().index, 1U);
        EXPECT_EQ(read.front().points->size(), scans[1].points->size());
        EXPECT_TRUE(reader.recording().findings.empty());
        EXPECT_EQ(reader.fraction(), 1);
    }
}

TEST(TurnAssembler, DamageComesAfterTheLastTurn) {
    TurnAssembler reader(std::make_unique<ListReader>(partsOfTurns(5, 2), true));
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(reader.next()) << i;
    EXPECT_THROW(reader.next(), Error);
}
}  // namespace
