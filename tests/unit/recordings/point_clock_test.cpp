#include "recordings/point_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace delio::io {
namespace {
constexpr std::size_t kPoints = 1000;
using TimeOf = std::function<double(std::size_t scan, std::size_t point)>;

double share(std::size_t point) { return static_cast<double>(point) / (kPoints - 1); }

/** Times of scans a tenth of a second apart. */
struct Drive {
    TimeOf timeOf;
    double begin_s = 1700000000;
    bool is32Bit = false;
    std::size_t looked = 5;
    PointClock clock{};

    RecordedTimes recorded(std::size_t scan) const {
        RecordedTimes times{{},
                            std::vector<bool>(kPoints, true),
                            is32Bit,
                            begin_s + 0.1 * static_cast<double>(scan),
                            scan};
        for (std::size_t i = 0; i < kPoints; ++i) {
            const double time = timeOf(scan, i);
            times.values.push_back(is32Bit ? std::fmod(time + 4294967296.0, 4294967296.0) : time);
        }
        return times;
    }
    /** Looks ahead, then takes the times of all scans. */
    std::vector<std::vector<float>> of(std::size_t scans) {
        for (std::size_t i = 0; i < looked; ++i) clock.look(recorded(i));
        std::vector<std::vector<float>> times;
        for (std::size_t i = 0; i < scans; ++i) times.push_back(clock.secondsOf(recorded(i)));
        return times;
    }
    std::string findings() const {
        std::string text;
        for (const auto& line : clock.findings()) text += line + "\n";
        return text;
    }
};

/** A turn of 0.1 s from `from_s` on; -1: of no point that `isLeftOut`. */
void expectTurn(const std::vector<float>& times, double from_s,
                const std::function<bool(std::size_t)>& isLeftOut = {}) {
    ASSERT_EQ(times.size(), kPoints);
    for (std::size_t i = 0; i < kPoints; ++i)
        if (isLeftOut && isLeftOut(i))
            ASSERT_TRUE(std::isnan(times[i])) << i;
        else
            ASSERT_NEAR(times[i], from_s + 0.1 * share(i), 2e-6) << i;
}
}  // namespace

TEST(PointClock, OneWildTimeCostsOnePoint) {
    for (const double wild : {3.6, -1e9, 1e300, double{INFINITY}, double{NAN}}) {
        Drive drive{[&](std::size_t scan, std::size_t i) {
            return scan == 0 && i == 7 ? wild : 0.1 * share(i);
        }};
        drive.looked = 1;
        const auto times = drive.of(3);
        expectTurn(times[0], 0, [](std::size_t i) { return i == 7; });
        expectTurn(times[1], 0);
        EXPECT_EQ(drive.findings(),
                  "points without a valid time: ignored: 1 point of 1 scan (first: scan 0)\n");
    }
}

TEST(PointClock, AFirstScanThatIsNotLikeTheOthers) {
    Drive drive{[](std::size_t scan, std::size_t i) { return (scan == 0 ? 3.6 : 0.1) * share(i); }};
    const auto times = drive.of(5);
    EXPECT_TRUE(times[0].empty());
    for (std::size_t scan = 1; scan < 5; ++scan) expectTurn(times[scan], 0);
    EXPECT_NE(drive.findings().find("invalid point times"), std::string::npos) << drive.findings();
    EXPECT_NE(drive.findings().find("1 scan (first: scan 0)"), std::string::npos);
}

TEST(PointClock, ScansWithoutTimesDoNotDecide) {
    Drive drive{
        [](std::size_t scan, std::size_t i) { return scan < 2 ? 0 : 1e9 * 0.1 * share(i); }};
    const auto times = drive.of(4);
    EXPECT_TRUE(times[1].empty());
    expectTurn(times[2], 0);
    EXPECT_EQ(drive.findings(), "");
}

TEST(PointClock, NumbersOf32BitsThatWrap) {
    for (const bool all : {true, false}) {
        Drive drive{[&](std::size_t scan, std::size_t i) {
            return 1e9 * 0.1 * share(i) - (all || scan == 2 ? 2e6 : 0);
        }};
        drive.is32Bit = true;
        const auto times = drive.of(3);
        expectTurn(times[1], all ? -0.002 : 0);
        expectTurn(times[2], -0.002);
        EXPECT_NE(drive.findings().find("wrapped at 2^32"), std::string::npos) << drive.findings();
    }
}

// A Livox counts from when it was switched on, which is near the drive's begin.
TEST(PointClock, TimesThatGoOnFromScanToScan) {
    Drive drive{[](std::size_t scan, std::size_t i) {
        return 1e9 * (0.1 * static_cast<double>(scan % 12) + 0.1 * share(i));
    }};
    const auto times = drive.of(20);
    for (std::size_t scan = 0; scan < 20; ++scan) expectTurn(times[scan], 0);
    EXPECT_NE(drive.findings().find("continue across scans"), std::string::npos);
}

// ouster-ros writes 0 for columns that were lost; the first one is not at the stamp.
TEST(PointClock, ZerosFarFromOtherTimesAreNone) {
    const auto isLost = [](std::size_t i) { return i % 11 == 5; };
    Drive lost{[&](std::size_t, std::size_t i) {
        return isLost(i) ? 0 : 49416704 + 1e9 * 0.1 * share(i);
    }};
    expectTurn(lost.of(1)[0], 0.049416704, isLost);
    Drive near{[](std::size_t, std::size_t i) { return i < 20 ? 0 : 1e9 * 0.1 * share(i); }};
    EXPECT_EQ(near.of(1)[0][3], 0);
}

TEST(PointClock, AClockThatChangesIsFoundAgain) {
    Drive drive{[](std::size_t scan, std::size_t i) {
        return (scan < 6 || scan == 8 ? 1 : 1e6) * 0.1 * share(i);
    }};
    const auto times = drive.of(13);
    expectTurn(times[5], 0);
    for (const std::size_t scan : {6U, 7U, 9U, 10U}) EXPECT_TRUE(times[scan].empty()) << scan;
    expectTurn(times[8], 0);
    expectTurn(times[11], 0);
    expectTurn(times[12], 0);
    EXPECT_NE(drive.findings().find("are in us from here on instead of s"), std::string::npos);
    EXPECT_NE(drive.findings().find("4 scans (first: scan 6)"), std::string::npos);
}

TEST(PointClock, UnixTimesThatJump) {
    const auto jumps = [](const std::function<double(std::size_t)>& begin_s) {
        Drive drive{
            [&](std::size_t scan, std::size_t i) { return begin_s(scan) + 0.1 * share(i); }};
        drive.begin_s = 0;  // the stamps are nominal
        expectTurn(drive.of(8)[7], 0);
        return drive.findings();
    };
    const auto of = [](std::size_t scan) { return 1.6e9 + 0.05 * static_cast<double>(scan); };
    EXPECT_EQ(jumps(of), "");
    EXPECT_NE(jumps([&](std::size_t scan) {
                  return of(scan) + (scan > 3 ? 7 : 0);
              }).find("jump but stamps do not"),
              std::string::npos);
    EXPECT_NE(jumps([&](std::size_t scan) { return of(scan == 4 ? 1 : scan); }).find("scan 4"),
              std::string::npos);
}
}  // namespace delio::io
