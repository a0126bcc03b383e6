#include "delio/run/doubts.h"

#include <gtest/gtest.h>

namespace {
using namespace delio;
using run::RunRow;

/** Scans 5, 6, 7 ...: '.' registered, 'p' predicted, 'w' an axis not observed, 'i' interrupted, 's'
 *  searched, '0' standing. */
std::vector<RunRow> rowsOf(const std::string& kinds) {
    std::vector<RunRow> rows;
    for (const char kind : kinds) {
        RunRow row;
        row.scan = 5 + rows.size();
        row.predicted = kind == 'p';
        row.interrupted = kind == 'i';
        row.searched = kind == 's';
        row.standing = kind == '0';
        if (kind == 'w' || kind == 'p') row.quality.unobservedTranslation.setIdentity(3, 1);
        rows.push_back(row);
    }
    return rows;
}

TEST(Doubts, AreCountedWithTheirLongestStretch) {
    const auto doubts = run::doubtsOf(rowsOf(".pp.ppp..ww.wi"));
    EXPECT_EQ(doubts.pairs, 13U);
    EXPECT_EQ(doubts.predicted.scans, 5U);
    EXPECT_EQ(doubts.predicted.longest, 3U);
    EXPECT_EQ(doubts.predicted.from, 9U);
    EXPECT_EQ(doubts.weak.scans, 3U);  // a predicted scan is no weak one
    EXPECT_EQ(doubts.weak.longest, 2U);
    EXPECT_EQ(doubts.weak.from, 14U);
    EXPECT_EQ(doubts.interrupted.scans, 1U);
    EXPECT_EQ(doubts.interrupted.from, 18U);
}

TEST(Doubts, SearchedScansAreCountedAndNoWarning) {
    const auto doubts = run::doubtsOf(rowsOf("..ss.sss.."));
    EXPECT_EQ(doubts.searched.scans, 5U);
    EXPECT_EQ(doubts.searched.longest, 3U);
    EXPECT_EQ(doubts.searched.from, 10U);
    EXPECT_TRUE(run::warningsOf(doubts).empty());
    EXPECT_EQ(run::textOf(doubts.searched, 5), "5, longest run 3 (from scan 10)");
    EXPECT_EQ(run::textOf(doubts.predicted, 0), "0");
}

TEST(Doubts, StandingScansAreCountedAndNoWarning) {
    const auto doubts = run::doubtsOf(rowsOf(".000..0000"));
    EXPECT_EQ(doubts.standing.scans, 7U);
    EXPECT_EQ(doubts.standing.longest, 4U);
    EXPECT_EQ(doubts.standing.from, 11U);
    EXPECT_TRUE(run::warningsOf(doubts).empty());
}

TEST(Doubts, WeakAxesAreTheVehicles) {
    auto rows = rowsOf(".wwww.");
    EXPECT_EQ(run::weakAxesOf(run::doubtsOf(rows)), "along x in 4");
    // A sensor that looks to the left: its x is the vehicle's y.
    rows[1].sensorPose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    // Two that are open, neither along one of the vehicle's; both nearest to x count once.
    auto& axes = rows[2].quality.unobservedTranslation;
    axes.resize(3, 2);
    axes << 0.8, -0.8, 0.6, 0.6, 0, 0;
    rows[3].quality.unobservedTranslation.resize(3, 0);
    rows[3].quality.unobservedRotation = -Eigen::Vector3d::UnitZ();
    const auto doubts = run::doubtsOf(rows);
    EXPECT_EQ(doubts.weak.scans, 4U);
    EXPECT_EQ(run::weakAxesOf(doubts), "along x in 2, along y in 1, about z in 1");
    const auto warnings = run::warningsOf(doubts);
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("along x in 2, along y in 1, about z in 1"), std::string::npos);
}

/** A scan of each track; the digits are Step::track. */
run::RunRecord recordOf(const std::string& tracks) {
    run::RunRecord record;
    record.rows = rowsOf(std::string(tracks.size(), '.'));
    for (std::size_t i = 0; i < tracks.size(); ++i)
        record.rows[i].track = static_cast<std::size_t>(tracks[i] - '0');
    return record;
}

TEST(Doubts, ScansOfANewMapAreUnlinked) {
    const auto unlinked = run::unlinkedOf(recordOf("0000111112"));
    EXPECT_EQ(unlinked.scans,
              4U);  // 3 of the first track, which has a first scan, and 1 of the last
    EXPECT_EQ(unlinked.longest, 3U);
    EXPECT_EQ(unlinked.from, 6U);
    EXPECT_EQ(run::unlinkedOf(recordOf("0000000")).scans, 0U);
    EXPECT_EQ(run::unlinkedOf({}).scans, 0U);
}

TEST(Doubts, AMapThatIsFoundAgainLinksTheScansBetween) {
    EXPECT_EQ(run::unlinkedOf(recordOf("0000111000")).scans, 0U);
    EXPECT_EQ(run::unlinkedOf(recordOf("0001110002222222")).scans, 7U);
}

TEST(Doubts, ALoopLinksTwoTracks) {
    auto record = recordOf("000011111");
    record.loops.resize(1);
    record.loops[0].fromNode = 1;
    record.loops[0].toNode = 7;
    record.loops[0].closure.reason = "too few points agree";
    EXPECT_EQ(run::unlinkedOf(record).scans, 3U);  // it was rejected
    record.loops[0].closure.reason.clear();
    EXPECT_EQ(run::unlinkedOf(record).scans, 0U);
}

TEST(Doubts, ATenthOfUnlinkedScansIsTooMuch) {
    const auto why = [](const std::string& tracks) {
        return run::whyUnreliable(run::unlinkedOf(recordOf(tracks)), tracks.size() - 1);
    };
    EXPECT_EQ(why(std::string(30, '0') + "111"), "");
    EXPECT_NE(
        why(std::string(30, '0') + "1111").find("4 of 33 scans (longest run 4, from scan 35)"),
        std::string::npos);
}

TEST(Doubts, TheFirstScanHasNothingBeforeIt) {
    EXPECT_EQ(run::doubtsOf({}).pairs, 0U);
    const auto doubts = run::doubtsOf(rowsOf("w"));
    EXPECT_EQ(doubts.pairs, 0U);
    EXPECT_EQ(doubts.weak.scans, 0U);
    EXPECT_TRUE(run::warningsOf(doubts).empty());
}

TEST(Doubts, AFewScansAreNoWarningManyAre) {
    const std::string good(40, '.');
    EXPECT_TRUE(run::warningsOf(run::doubtsOf(rowsOf(good + "pp"))).empty());  // 2 of 41
    const auto many = run::warningsOf(run::doubtsOf(rowsOf(good + "ppp" + good.substr(0, 10))));
    ASSERT_EQ(many.size(), 1U);
    EXPECT_EQ(many[0].rfind("3 of 52 scans (longest run 3, from scan 45)", 0), 0U) << many[0];
    EXPECT_EQ(run::warningsOf(run::doubtsOf(rowsOf("..w.p."))).size(), 2U);
}

TEST(Doubts, EveryInterruptionIsToldOf) {
    const auto warnings = run::warningsOf(run::doubtsOf(rowsOf(std::string(90, '.') + "i...")));
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings[0].find("from scan 95"), std::string::npos) << warnings[0];
}
}  // namespace
