#include <gtest/gtest.h>

#include <limits>

#include "delio/core/error.h"
#include "slam_drive.h"

// Listeners and odometries that fail on a scan, and listeners that do not.
namespace {
using namespace delio;
using namespace delio::slam_test;

/** An odometry that knows its steps; empty ones are faults. */
class Replay : public Odometry {
 public:
    explicit Replay(std::vector<std::optional<Step>> steps) : steps_(std::move(steps)) {}
    Step process(const Scan&) override {
        const auto& step = steps_.at(next_++);
        if (!step) throw Error("the odometry failed");
        return *step;
    }

 private:
    std::vector<std::optional<Step>> steps_;
    std::size_t next_ = 0;
};

/** Counts, and notes what it is told of. */
class Counter : public SlamListener {
 public:
    const char* name() const override { return "counter"; }
    void add(const SlamScan& scan) override {
        nodes.push_back(scan.node);
        indices.push_back(scan.scan.index);
        stamps_s.push_back(scan.scan.stamp_s);
        poses.push_back(scan.pose);
    }
    std::vector<std::size_t> nodes, indices;
    std::vector<double> stamps_s;
    Poses poses;
};

/** Fails on the scan with this index. */
class Thrower : public SlamListener {
 public:
    explicit Thrower(std::size_t index) : index_(index) {}
    const char* name() const override { return "thrower"; }
    void add(const SlamScan& scan) override {
        latest = scan.scan.index;
        if (latest == index_) throw Error("the listener failed");
    }

    std::size_t latest = 0;  //!< that it was told of

 private:
    std::size_t index_;
};

/** All that Slam and its listeners know. */
struct State {
    explicit State(const Mapping& mapping)
        : trajectory(mapping.slam.trajectory()),
          graph(mapping.graph->graph()),
          points(map::cloudOf(mapping.map->builder().build(mapping.poses()).points)),
          keyPoses(mapping.map->builder().build(mapping.poses()).keyPoses) {}

    io::Trajectory trajectory;
    graph::PoseGraph graph;
    mrpt::maps::CPointsMapXYZI points;
    Poses keyPoses;
};

void expectSameBytes(const State& a, const State& b) {
    slam_test::expectSameBytes(a.trajectory.poses, b.trajectory.poses);
    EXPECT_EQ(a.trajectory.stamps_s, b.trajectory.stamps_s);
    slam_test::expectSameBytes(a.graph, b.graph);
    EXPECT_EQ(a.points.getPointsBufferRef_x(), b.points.getPointsBufferRef_x());
    EXPECT_EQ(a.points.getPointsBufferRef_y(), b.points.getPointsBufferRef_y());
    EXPECT_EQ(a.points.getPointsBufferRef_z(), b.points.getPointsBufferRef_z());
    slam_test::expectSameBytes(a.keyPoses, b.keyPoses);
}

/** Skip edges and a window, and a map that every scan is a keyframe of. */
Options options() {
    Options options = withSkipEdges(2);
    options.graph.window = 4;
    options.map.keyframeDistance_m = 0.3;
    return options;
}

/** A drive and its odometry's steps. */
class SlamFailure : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        scans = scansOf(drive(9), mounting());
        // The sensor may be turned on its vehicle.
        for (std::size_t i = 0; i < scans.size(); ++i)
            scans[i].sensorPose =
                mounting() * test::poseAt(0, 0, 0, 0.1 * static_cast<double>(i % 3));
        const auto odometry = makeOdometry(options());
        for (const auto& scan : scans) steps.emplace_back(odometry->process(scan));
    }

    static std::unique_ptr<Odometry> replay(std::vector<std::optional<Step>> given = steps) {
        return std::make_unique<Replay>(std::move(given));
    }

    static std::vector<Scan> scans;
    static std::vector<std::optional<Step>> steps;
};
std::vector<Scan> SlamFailure::scans;
std::vector<std::optional<Step>> SlamFailure::steps;

TEST_F(SlamFailure, AListenerThatThrowsIsSwitchedOffAndTheOthersGoOn) {
    Mapping undisturbed(options(), replay());
    for (const auto& scan : scans) undisturbed.slam.process(scan);
    const State expected(undisturbed);
    for (const std::size_t bad : {0, 1, 4, 8}) {
        SCOPED_TRACE(bad);
        for (const int place : {0, 1, 2}) {
            SCOPED_TRACE(place);
            const auto thrower = std::make_shared<Thrower>(scans[bad].index);
            const std::shared_ptr<SlamListener> none;
            Mapping mapping(options(), replay(), place == 0 ? thrower : none,
                            place == 1 ? thrower : none, place == 2 ? thrower : none);
            for (std::size_t i = 0; i < scans.size(); ++i) {
                const auto report = mapping.slam.process(scans[i]);
                ASSERT_EQ(report.failed.size(), i == bad ? 1U : 0U) << i;
                EXPECT_EQ(report.listeners_ms.size(), 3U) << i;
                if (i != bad) continue;
                EXPECT_EQ(report.failed[0].listener, thrower);
                EXPECT_EQ(report.failed[0].message, "the listener failed");
            }
            EXPECT_EQ(thrower->latest, scans[bad].index);
            expectSameBytes(State(mapping), expected);
        }
    }
}

TEST_F(SlamFailure, AnOdometryThatThrowsChangesNothing) {
    auto withFault = steps;
    withFault[4].reset();
    const auto counter = std::make_shared<Counter>();
    Mapping mapping(options(), replay(withFault), counter);
    for (std::size_t i = 0; i < 4; ++i) mapping.slam.process(scans[i]);
    const State before(mapping);
    EXPECT_THROW(mapping.slam.process(scans[4]), Error);
    expectSameBytes(State(mapping), before);
    EXPECT_EQ(counter->nodes.size(), 4U);
    mapping.slam.process(scans[5]);
    EXPECT_EQ(counter->nodes.back(), 4U);
}

// With listeners that would notice, and without any.
TEST_F(SlamFailure, AnIncrementThatIsNotFiniteIsRefused) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    auto badTranslation = steps, badRotation = steps, badCovariance = steps;
    badTranslation[4]->increment.pose.translation().y() = kNaN;
    badRotation[4]->increment.pose.linear()(1, 2) = std::numeric_limits<double>::infinity();
    badCovariance[4]->increment.covariance(3, 3) = kNaN;
    for (const auto& bad : {badTranslation, badRotation, badCovariance}) {
        const auto counter = std::make_shared<Counter>();
        Mapping mapping(options(), replay(bad), {}, {}, counter);
        Slam alone(replay(bad));
        for (std::size_t i = 0; i < 4; ++i) {
            mapping.slam.process(scans[i]);
            alone.process(scans[i]);
        }
        const State before(mapping);
        EXPECT_THROW(mapping.slam.process(scans[4]), Error);
        EXPECT_THROW(alone.process(scans[4]), Error);
        expectSameBytes(State(mapping), before);
        slam_test::expectSameBytes(alone.trajectory().poses, before.trajectory.poses);
        // How far that scan led nobody knows; what comes after it is taken again.
        EXPECT_NO_THROW(mapping.slam.process(scans[5]));
        EXPECT_NO_THROW(alone.process(scans[5]));
        EXPECT_TRUE(mapping.poses().back().matrix().allFinite());
        EXPECT_EQ(counter->nodes.back(), 4U);
    }
}

TEST_F(SlamFailure, AListenerHearsOfEveryScanFromTheNextOneOn) {
    const auto first = std::make_shared<Counter>(), late = std::make_shared<Counter>();
    Mapping mapping(options(), replay(), first);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (i == 3) mapping.slam.attach(late);
        const auto report = mapping.slam.process(scans[i]);
        std::vector<std::string> names;
        for (const auto& [name, ms] : report.listeners_ms) {
            names.emplace_back(name);
            EXPECT_GE(ms, 0);
        }
        std::vector<std::string> expected{"counter", "graph", "map"};
        if (i >= 3) expected.emplace_back("counter");
        EXPECT_EQ(names, expected);
        EXPECT_EQ(first->indices.back(), scans[i].index);
    }
    EXPECT_EQ(first->stamps_s, mapping.slam.trajectory().stamps_s);
    slam_test::expectSameBytes(first->poses, mapping.slam.trajectory().poses);
    EXPECT_EQ(late->nodes, (std::vector<std::size_t>{3, 4, 5, 6, 7, 8}));
    // That it listens changes nothing.
    Mapping without(options(), replay());
    for (const auto& scan : scans) without.slam.process(scan);
    expectSameBytes(State(mapping), State(without));
}
}  // namespace
