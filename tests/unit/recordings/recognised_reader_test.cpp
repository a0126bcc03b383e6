#include "recordings/recognised_reader.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "delio/core/error.h"

namespace delio::io {
namespace {
/** Scans of one ring that turns, of a vehicle that sets off at one of them; then a fault, perhaps.
 */
class Source : public ScanReader {
 public:
    std::size_t scans = 4, departs = 1000, faultAt = 1000;
    bool timed = true;
    std::size_t untimed = 0;  //!< the first ones have no times
    bool shuffled = false;    //!< times are those of other points
    std::optional<bool> told;
    std::string imu;              //!< its name
    std::size_t* read = nullptr;  //!< scans that were read
    std::function<double(std::size_t)> stampOf = [](std::size_t scan) {
        return 100 + 0.1 * static_cast<double>(scan);
    };
    std::optional<DriveMeta> known;

    std::optional<Scan> next() override {
        if (given_ == faultAt) {
            given_ = scans;
            throw Error("cut off");
        }
        if (given_ >= scans) return {};
        if (read) ++*read;
        return scanAt(given_++);
    }
    bool skip() override { return next().has_value(); }
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return others_; }
    std::optional<double> fraction() const override {
        return static_cast<double>(given_) / static_cast<double>(scans);
    }
    const std::optional<DriveMeta>& meta() const override { return known; }
    Recording recording() const override {
        Recording recording;
        recording.kind = "test";
        recording.sensor = "Spinner";
        recording.motionCompensated = told;
        recording.imu = imu;
        return recording;
    }

 private:
    Scan scanAt(std::size_t index) const {
        Scan scan;
        scan.index = index;
        scan.stamp_s = stampOf(index);
        auto points = mrpt::maps::CSimplePointsMap::Create();
        const double speed_ms = index >= departs ? 20 : 0;
        for (int i = 0; i < 2000; ++i) {
            const double time_s = 0.1 * i / 2000, azimuth = 20 * M_PI * time_s;
            points->insertPoint(
                static_cast<float>(10 * std::cos(azimuth) + speed_ms * (time_s - 0.05)),
                static_cast<float>(10 * std::sin(azimuth)), 1);
            scan.rings.push_back(0);
            if (timed && index >= untimed) scan.times_s.push_back(static_cast<float>(time_s));
        }
        scan.points = points;
        if (shuffled)
            std::shuffle(scan.times_s.begin(), scan.times_s.end(), std::mt19937(index + 1));
        return scan;
    }

    std::size_t given_ = 0;
    std::string label_ = "spinner";
    std::set<std::string> others_;
};

RecognisedReader readerOf(const std::function<void(Source&)>& set,
                          Delivery delivery = Delivery::kFile) {
    auto source = std::make_unique<Source>();
    set(*source);
    return RecognisedReader(std::move(source), delivery);
}
}  // namespace

TEST(RecognisedReader, SaysWhatItIsBeforeTheFirstScan) {
    auto reader = readerOf([](Source&) {});
    EXPECT_EQ(describe(reader.recording()),
              "Spinner, 10 Hz, points with times, not de-skewed by the recorder (measured) (test)");
    ASSERT_TRUE(reader.meta());
    EXPECT_FALSE(reader.meta()->motionCompensated);
    EXPECT_EQ(reader.meta()->sensorModel, "Spinner");
    for (std::size_t i = 0; i < 4; ++i) {
        const auto scan = reader.next();
        ASSERT_TRUE(scan);
        EXPECT_EQ(scan->index, i);
    }
    EXPECT_FALSE(reader.next());
    EXPECT_FALSE(reader.skip());
}

TEST(RecognisedReader, WhatTheSourceSaysIsBelieved) {
    const auto reader = readerOf([](Source& source) {
        source.told = true;
        source.known.emplace();
        source.known->sensorModel = "HDL-64E";
    });
    EXPECT_FALSE(reader.recording().compensationMeasured);
    EXPECT_EQ(reader.meta()->sensorModel, "HDL-64E");
}

TEST(RecognisedReader, WithoutTimesNothingIsClaimed) {
    const auto reader = readerOf([](Source& source) { source.timed = false; });
    EXPECT_EQ(describe(reader.recording()), "Spinner, 10 Hz, points without times (test)");
    EXPECT_FALSE(reader.meta());
}

TEST(RecognisedReader, AVehicleThatStoodFirstIsLookedAtAgain) {
    auto reader = readerOf([](Source& source) {
        source.scans = 50;
        source.departs = 30;
    });
    while (reader.next()) continue;
    EXPECT_EQ(reader.recording().compensatedAfterAll, std::optional<std::size_t>(40));
}

TEST(RecognisedReader, StampsRise) {
    auto reader = readerOf([](Source& source) {
        source.scans = 10;
        source.stampOf = [](std::size_t scan) {
            if (scan == 7) return 100.6;
            const std::size_t order[] = {0, 1, 2, 4, 3, 5, 6, 7, 8, 9};
            return 100 + 0.1 * static_cast<double>(order[scan]);
        };
    });
    std::vector<std::size_t> scans;
    while (const auto scan = reader.next()) scans.push_back(scan->index);
    EXPECT_EQ(scans, (std::vector<std::size_t>{0, 1, 2, 4, 3, 5, 6, 8, 9}));
    EXPECT_EQ(reader.recording().findings.size(), 2U);
}

/** How many scans are read when the reader is made, and when each scan is given. */
std::vector<std::size_t> readsOf(Delivery delivery, const std::string& imu) {
    std::size_t read = 0;
    auto reader = readerOf(
        [&](Source& source) {
            source.scans = 6;
            source.imu = imu;
            source.read = &read;
        },
        delivery);
    std::vector<std::size_t> reads{read};
    while (reader.next()) reads.push_back(read);
    return reads;
}

TEST(RecognisedReader, AScanOfASensorIsGivenAtOnce) {
    using Reads = std::vector<std::size_t>;
    EXPECT_EQ(readsOf(Delivery::kSensor, ""), (Reads{1, 1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(readsOf(Delivery::kSensor, "imu"), (Reads{1, 2, 3, 4, 5, 6, 6}));
    EXPECT_EQ(readsOf(Delivery::kPackets, ""), (Reads{3, 3, 3, 3, 4, 5, 6}));
    EXPECT_EQ(readsOf(Delivery::kPackets, "imu"), (Reads{3, 3, 3, 4, 5, 6, 6}));
    EXPECT_EQ(readsOf(Delivery::kPipe, ""), (Reads{3, 3, 4, 4, 4, 5, 6}));
    EXPECT_EQ(readsOf(Delivery::kPipe, "imu"), readsOf(Delivery::kFile, "imu"));
}

// Not how far was read ahead.
TEST(RecognisedReader, FractionIsThatOfTheScansThatWereGiven) {
    auto reader = readerOf([](Source& source) { source.scans = 10; });
    EXPECT_EQ(reader.fraction(), std::optional<double>(0));
    for (int given = 1; given <= 10; ++given) {
        EXPECT_TRUE(given == 4 ? reader.skip() : reader.next().has_value());
        EXPECT_EQ(reader.fraction(), std::optional<double>(given / 10.0));
    }
}

TEST(RecognisedReader, FirstScansWithoutTimesAreLeftOut) {
    for (const std::size_t untimed : {1U, 2U, 1000U}) {
        auto reader = readerOf([&](Source& source) {
            source.scans = 6;
            source.untimed = untimed;
        });
        const bool any = untimed < 6;
        EXPECT_EQ(reader.recording().pointTimes, any);
        EXPECT_EQ(reader.next()->index, any ? untimed : 0U);
        ASSERT_EQ(reader.recording().findings.size(), any ? 1U : 0U);
    }
}

TEST(RecognisedReader, TimesOfOtherPointsAreNotUsed) {
    auto reader = readerOf([](Source& source) { source.shuffled = true; });
    EXPECT_FALSE(reader.recording().pointTimes);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(reader.next()->times_s.empty());
    EXPECT_EQ(reader.recording().findings,
              std::vector<std::string>{
                  "point times contradict the azimuths: not used: 4 scans (first: scan 0)"});
}

TEST(RecognisedReader, AFaultComesAfterWhatIsAhead) {
    for (const std::size_t at : {0U, 1U, 2U, 3U}) {
        auto reader = readerOf([&](Source& source) { source.faultAt = at; });
        for (std::size_t i = 0; i < at; ++i)
            EXPECT_TRUE(i % 2 == 0 ? !!reader.next() : reader.skip());
        EXPECT_THROW(reader.next(), Error);
        EXPECT_FALSE(reader.next());
    }
}
}  // namespace delio::io
