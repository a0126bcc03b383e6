#include "recordings/stamp_order.h"

#include <gtest/gtest.h>

#include <random>

namespace delio::io {
namespace {
struct Given {
    std::vector<std::size_t> scans;
    std::vector<double> stamps_s;
    std::string findings;
};

/** What is given of scans that are stamped so. `isLive`: scans are read ahead only where isNext()
 *  does not know the first one. */
Given givenOf(const std::vector<double>& stamps_s, bool isLive = false,
              bool startsInOrder = false) {
    StampOrder order(startsInOrder);
    std::deque<Scan> ahead;
    Given given;
    std::size_t read = 0;
    while (true) {
        for (; read < stamps_s.size() && ahead.size() < StampOrder::kWindow; ++read) {
            if (isLive && !ahead.empty() && order.isNext(ahead.front())) break;
            ahead.emplace_back();
            ahead.back().index = read;
            ahead.back().stamp_s = stamps_s[read];
            ahead.back().time = mrpt::Clock::fromDouble(1e9 + stamps_s[read]);
        }
        if (ahead.empty()) break;
        if (const auto scan = order.take(ahead)) {
            given.scans.push_back(scan->index);
            given.stamps_s.push_back(scan->stamp_s);
            EXPECT_NEAR(mrpt::Clock::toDouble(scan->time), 1e9 + scan->stamp_s, 2e-6);
        }
    }
    for (const auto& line : order.findings()) given.findings += line + "\n";
    for (std::size_t i = 1; i < given.stamps_s.size(); ++i)
        EXPECT_GT(given.stamps_s[i], given.stamps_s[i - 1]) << i;
    return given;
}

std::vector<double> even(std::size_t count) {
    std::vector<double> stamps_s;
    for (std::size_t i = 0; i < count; ++i) stamps_s.push_back(0.1 * static_cast<double>(i));
    return stamps_s;
}
using Scans = std::vector<std::size_t>;
}  // namespace

TEST(StampOrder, RisingStampsStayAsTheyAre) {
    const std::vector<double> uneven{0, 0.1, 0.15, 0.151, 3, 3.1, 3.2};
    const auto given = givenOf(uneven);
    EXPECT_EQ(given.stamps_s, uneven);
    EXPECT_EQ(given.findings, "");
    EXPECT_TRUE(givenOf({}).scans.empty());
    EXPECT_EQ(givenOf({5}).stamps_s, std::vector<double>{5});
}

TEST(StampOrder, ReadingAheadOnlyWhereNeededGivesTheSame) {
    std::mt19937 random(7);
    const auto draw = [&](int most) { return std::uniform_int_distribution<int>(0, most)(random); };
    for (int drive = 0; drive < 500; ++drive) {
        auto stamps = even(40);
        for (int fault = draw(6); fault > 0; --fault) {
            const auto at = static_cast<std::size_t>(draw(36));
            const double by_s = 0.05 * (draw(40) - 20);
            const int kind = draw(4);
            if (kind == 0) std::swap(stamps[at], stamps[at + 1]);
            if (kind == 1) std::swap(stamps[at], stamps[at + 2]);
            if (kind == 2) stamps[at] += by_s;
            if (kind == 3)  // a pause, or a clock that was set
                for (std::size_t i = at; i < stamps.size(); ++i) stamps[i] += by_s;
            if (kind == 4) stamps.erase(stamps.begin() + static_cast<std::ptrdiff_t>(at));
        }
        for (const bool inOrder : {false, true}) {
            const auto all = givenOf(stamps, false, inOrder), live = givenOf(stamps, true, inOrder);
            EXPECT_EQ(live.scans, all.scans) << drive;
            EXPECT_EQ(live.stamps_s, all.stamps_s) << drive;
            EXPECT_EQ(live.findings, all.findings) << drive;
        }
    }
}

TEST(StampOrder, AScanAtTheUsualIntervalNeedsNoLookAhead) {
    for (const bool startsInOrder : {false, true}) {
        StampOrder order(startsInOrder);
        std::deque<Scan> ahead;
        std::size_t known = 0;
        for (std::size_t i = 0; i < 20; ++i) {
            ahead.emplace_back();
            ahead.back().stamp_s = 0.1 * static_cast<double>(i);
            known += order.isNext(ahead.front());
            order.take(ahead);
        }
        EXPECT_EQ(known, startsInOrder ? 20U : 18U);  // two scans show the interval
    }
}

TEST(StampOrder, AShortFirstIntervalIsNotTheUsualOne) {
    const std::vector<double> stamps_s{0, 0.05, 0.15, 0.25, 0.35};  // the first scan is half a turn
    StampOrder order(true);
    std::deque<Scan> ahead;
    for (const double stamp_s : stamps_s) {
        ahead.emplace_back();
        ahead.back().stamp_s = stamp_s;
        EXPECT_TRUE(order.isNext(ahead.front())) << stamp_s;
        order.take(ahead);
    }
    EXPECT_EQ(givenOf(stamps_s, true, true).stamps_s, stamps_s);
    EXPECT_EQ(givenOf(stamps_s, false, true).stamps_s, stamps_s);
}

TEST(StampOrder, FirstScansInOrderStayInOrder) {
    const std::vector<double> swapped{0.1, 0, 0.2, 0.3};
    EXPECT_EQ(givenOf(swapped).scans, (Scans{1, 0, 2, 3}));
    EXPECT_EQ(givenOf(swapped, false, true).scans, (Scans{0, 2, 3}));
}

TEST(StampOrder, SwappedScansAreSorted) {
    auto stamps = even(8);
    std::swap(stamps[4], stamps[5]);
    EXPECT_EQ(givenOf(stamps).scans, (Scans{0, 1, 2, 3, 5, 4, 6, 7}));
    EXPECT_EQ(givenOf(stamps).stamps_s, even(8));
    EXPECT_EQ(givenOf(stamps).findings,
              "scans recorded out of order: sorted by stamp: 1 scan (first: scan 5)\n");
    EXPECT_EQ(givenOf({0.1, 0, 0.2, 0.3}).scans, (Scans{1, 0, 2, 3}));
    EXPECT_EQ(givenOf({0, 0.1, 0.3, 0.4, 0.2, 0.5}).scans, (Scans{0, 1, 4, 2, 3, 5}));
    EXPECT_EQ(givenOf({0, 0.1, 0.3, 0.2}).scans, (Scans{0, 1, 3, 2}));
}

TEST(StampOrder, OneWrongStampCostsOneScan) {
    const auto with = [](std::size_t scan, double stamp_s) {
        auto stamps = even(8);
        stamps[scan] = stamp_s;
        return givenOf(stamps);
    };
    for (const double stamp_s : {0.3, 0.15, 0.1, -5.0, 0.65, 1e9}) {
        EXPECT_EQ(with(4, stamp_s).scans, (Scans{0, 1, 2, 3, 5, 6, 7})) << stamp_s;
        EXPECT_NE(with(4, stamp_s).findings.find("out of order: ignored: 1 scan (first: scan 4)"),
                  std::string::npos)
            << stamp_s;
    }
    EXPECT_EQ(with(7, 0.6).scans, (Scans{0, 1, 2, 3, 4, 5, 6}));
    // Nothing tells that the first one is wrong: the clock is taken as set back.
    EXPECT_EQ(with(0, 1e9).scans, (Scans{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(StampOrder, AClockThatWasSetBack) {
    auto stamps = even(8);
    for (std::size_t i = 4; i < 8; ++i) stamps[i] -= 10;
    const auto given = givenOf(stamps);
    EXPECT_EQ(given.scans, (Scans{0, 1, 2, 3, 4, 5, 6, 7}));
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(given.stamps_s[i], even(8)[i], 1e-9);
    EXPECT_NE(given.findings.find("1 scan (first: scan 4)"), std::string::npos) << given.findings;
    EXPECT_EQ(givenOf({10, 10.1, 0.2, 0.3, 0.4}).scans, (Scans{0, 1, 2, 3, 4}));
}

TEST(StampOrder, AClockThatStands) {
    const auto given = givenOf(std::vector<double>(6, 7));
    EXPECT_EQ(given.scans, (Scans{0, 1, 2, 3, 4, 5}));
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(given.stamps_s[i], 7 + even(6)[i], 1e-9);
    EXPECT_NE(given.findings.find("5 scans (first: scan 1)"), std::string::npos);
}
}  // namespace delio::io
