#include "delio/slam/live_slam.h"

#include <gtest/gtest.h>

#include "slam_drive.h"

namespace {
using namespace delio;
using namespace delio::slam_test;

/** Counts what it gets, in the thread of the Slam. */
class Counter : public SlamListener {
 public:
    const char* name() const override { return "counter"; }
    void add(const SlamScan& scan) override { stamps_s.push_back(scan.scan.stamp_s); }
    std::vector<double> stamps_s;
};

TEST(LiveSlam, GivesThePosesOfTheSlam) {
    const auto scans = scansOf(drive(4));
    const auto options = withoutGraph();
    Slam plain(makeOdometry(options));
    for (const auto& scan : scans) plain.process(scan);

    auto slam = std::make_unique<Slam>(makeOdometry(options));
    const auto counter = std::make_shared<Counter>();
    slam->attach(counter);
    LiveSlam live(std::move(slam), scans.size() + 1);
    std::thread driver([&] {
        for (const auto& scan : scans) {
            live.add(scan);
            if (&scan == &scans[0]) live.add(Scan());  // without points
        }
    });
    driver.join();
    live.finish();
    live.add(scans[0]);  // too late
    EXPECT_EQ(counter->stamps_s.size(), scans.size());
    ASSERT_EQ(live.slam().trajectory().poses.size(), scans.size());
    for (std::size_t i = 0; i < scans.size(); ++i)
        EXPECT_EQ(live.slam().trajectory().poses[i].matrix(), plain.trajectory().poses[i].matrix());
    const auto report = live.report();
    EXPECT_EQ(report.processed, scans.size());
    EXPECT_EQ(report.refused, 1U);
    EXPECT_NE(report.refusal, "");
    EXPECT_EQ(report.dropped, 0U);
}

/** Waits in its first scan until it may go on. */
class Slow : public SlamListener {
 public:
    explicit Slow(std::mutex& gate) : gate_(gate) {}
    const char* name() const override { return "slow"; }
    void add(const SlamScan&) override { const std::lock_guard lock(gate_); }

 private:
    std::mutex& gate_;
};

TEST(LiveSlam, DropsWhatItCannotProcess) {
    const auto scans = scansOf(drive(6));
    auto slam = std::make_unique<Slam>(makeOdometry(withoutGraph()), History::Last);
    std::mutex gate;
    slam->attach(std::make_shared<Slow>(gate));
    LiveSlam live(std::move(slam), 1);
    {
        const std::lock_guard lock(gate);
        for (const auto& scan : scans) live.add(scan);
    }
    live.finish();
    const auto report = live.report();
    EXPECT_EQ(report.processed + report.dropped, scans.size());
    EXPECT_GE(report.dropped, scans.size() - 2);  // one is processed, one waits
}
}  // namespace
