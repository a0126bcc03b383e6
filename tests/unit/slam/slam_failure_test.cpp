#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "delio/core/error.h"
#include "slam_drive.h"

// Listeners and odometries that fail on a scan, and listeners that do not.
namespace {
using namespace delio;
using namespace delio::slam_test;
using Eigen::Isometry3d;

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
    void undo() noexcept override {
        nodes.pop_back();
        indices.pop_back();
        stamps_s.pop_back();
        poses.pop_back();
        ++undone;
    }

    std::vector<std::size_t> nodes, indices;
    std::vector<double> stamps_s;
    Poses poses;
    unsigned undone = 0;
};

/** Fails on the scans with these indices. */
class Thrower : public SlamListener {
 public:
    explicit Thrower(std::vector<std::size_t> indices) : indices_(std::move(indices)) {}
    const char* name() const override { return "thrower"; }
    void add(const SlamScan& scan) override {
        for (const auto index : indices_)
            if (scan.scan.index == index) throw Error("the listener failed");
    }
    void undo() noexcept override {}

 private:
    std::vector<std::size_t> indices_;
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

    /** A run in which scan `first` and the `count` - 1 after it were never recorded. */
    static State withoutScans(std::size_t first, std::size_t count) {
        auto left = steps;
        auto rows = scans;
        for (std::size_t i = 0; i < count; ++i) {
            left[first + 1]->increment =
                chained(left[first]->increment, left[first + 1]->increment);
            left.erase(left.begin() + static_cast<std::ptrdiff_t>(first));
            rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(first));
        }
        Mapping mapping(options(), replay(left));
        for (const auto& scan : rows) mapping.slam.process(scan);
        return State(mapping);
    }

    static std::vector<Scan> scans;
    static std::vector<std::optional<Step>> steps;
};
std::vector<Scan> SlamFailure::scans;
std::vector<std::optional<Step>> SlamFailure::steps;

/** With the listener first, between graph and map, and last. */
void inEveryPlace(const std::shared_ptr<SlamListener>& listener,
                  const std::function<std::unique_ptr<Odometry>()>& odometry,
                  const std::function<void(Mapping&)>& act) {
    for (const int place : {0, 1, 2}) {
        SCOPED_TRACE(place);
        const std::shared_ptr<SlamListener> none;
        Mapping mapping(options(), odometry(), place == 0 ? listener : none,
                        place == 1 ? listener : none, place == 2 ? listener : none);
        act(mapping);
    }
}

TEST_F(SlamFailure, AListenerThatThrowsLeavesEverythingAsItWas) {
    for (const std::size_t bad : {0, 1, 4, 8}) {
        SCOPED_TRACE(bad);
        const auto thrower = std::make_shared<Thrower>(std::vector<std::size_t>{scans[bad].index});
        inEveryPlace(
            thrower, [] { return replay(); },
            [&](Mapping& mapping) {
                for (std::size_t i = 0; i < bad; ++i) mapping.slam.process(scans[i]);
                const State before(mapping);
                EXPECT_THROW(mapping.slam.process(scans[bad]), Error);
                expectSameBytes(State(mapping), before);
            });
    }
}

TEST_F(SlamFailure, TheScansAfterItComeOutAsIfItWereMissing) {
    Mapping whole(options(), replay());
    for (const auto& scan : scans) whole.slam.process(scan);
    const auto& expected = whole.slam.trajectory().poses;
    struct Case {
        std::size_t first, count;
    };
    for (const auto& [first, count] : {Case{4, 1}, Case{4, 3}, Case{1, 1}, Case{7, 1}}) {
        SCOPED_TRACE(first);
        std::vector<std::size_t> bad;
        for (std::size_t i = first; i < first + count; ++i) bad.push_back(scans[i].index);
        const State reference = withoutScans(first, count);
        inEveryPlace(
            std::make_shared<Thrower>(bad), [] { return replay(); },
            [&](Mapping& mapping) {
                for (std::size_t i = 0; i < scans.size(); ++i)
                    if (i >= first && i < first + count)
                        EXPECT_THROW(mapping.slam.process(scans[i]), Error);
                    else
                        mapping.slam.process(scans[i]);
                expectSameBytes(State(mapping), reference);
                const auto& poses = mapping.slam.trajectory().poses;
                ASSERT_EQ(poses.size(), scans.size() - count);
                for (std::size_t i = first + count; i < scans.size(); ++i) {
                    EXPECT_LT(test::metresBetween(poses[i - count], expected[i]), 1e-9) << i;
                    EXPECT_LT(test::degreesBetween(poses[i - count], expected[i]), 1e-6) << i;
                }
            });
    }
}

TEST_F(SlamFailure, TheEdgeOverItHasTheChainedCovariance) {
    const auto thrower = std::make_shared<Thrower>(std::vector<std::size_t>{scans[4].index});
    Mapping mapping(options(), replay(), {}, {}, thrower);
    for (std::size_t i = 0; i < scans.size(); ++i) try {
            mapping.slam.process(scans[i]);
        } catch (const Error&) {
            EXPECT_EQ(i, 4U);
        }
    const auto over = ofVehicle(chained(steps[4]->increment, steps[5]->increment),
                                scans[3].sensorPose, scans[5].sensorPose);
    for (const auto& edge : mapping.graph->graph().edges()) {
        if (edge.from != 3 || edge.to != 4) continue;
        EXPECT_EQ(edge.increment.covariance, over.covariance);
        EXPECT_EQ(edge.increment.pose.matrix(), over.pose.matrix());
        EXPECT_GT(edge.increment.covariance.trace(), steps[5]->increment.covariance.trace());
        return;
    }
    FAIL() << "no edge from node 3 to node 4";
}

// The next scan is the first one then.
TEST_F(SlamFailure, TheFirstScanMayFail) {
    const auto thrower = std::make_shared<Thrower>(std::vector<std::size_t>{scans[0].index});
    inEveryPlace(
        thrower, [] { return replay(); },
        [&](Mapping& mapping) {
            EXPECT_THROW(mapping.slam.process(scans[0]), Error);
            for (std::size_t i = 1; i < scans.size(); ++i) mapping.slam.process(scans[i]);
            auto rest = steps;
            rest.erase(rest.begin());
            Mapping reference(options(), replay(rest));
            for (std::size_t i = 1; i < scans.size(); ++i) reference.slam.process(scans[i]);
            expectSameBytes(State(mapping), State(reference));
            EXPECT_EQ(mapping.poses()[0].matrix(), Isometry3d::Identity().matrix());
        });
}

TEST_F(SlamFailure, OfTheRealOdometriesToo) {
    for (const auto& profile : Options::profileNames()) {
        auto ofProfile = Options::ofProfile(profile);
        ofProfile.paper.lineRegistration.search_radius = 0;
        const auto thrower = std::make_shared<Thrower>(std::vector<std::size_t>{scans[3].index});
        Mapping whole(ofProfile), mapping(ofProfile, makeOdometry(ofProfile), {}, {}, thrower);
        for (std::size_t i = 0; i < 6; ++i) {
            whole.slam.process(scans[i]);
            if (i == 3)
                EXPECT_THROW(mapping.slam.process(scans[i]), Error);
            else
                mapping.slam.process(scans[i]);
        }
        for (const std::size_t i : {4, 5})
            EXPECT_LT(test::metresBetween(mapping.slam.trajectory().poses[i - 1],
                                          whole.slam.trajectory().poses[i]),
                      1e-9)
                << profile;
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
    EXPECT_EQ(counter->undone, 0U);
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
        EXPECT_EQ(counter->undone, 0U);
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
