#include <filesystem>

#include "delio/slam/loop_closer.h"
#include "slam_drive.h"
#include "states.h"
#include "test_data.h"

// A drive that is stored after any scan goes on in other objects as if nothing had been.
namespace {
using namespace delio;
using namespace delio::slam_test;
using test::stateOf;

/** With a submap every few scans. */
Options optionsOf(const std::string& profile) {
    auto options = Options::ofProfile(profile);
    options.paper.lineRegistration.search_radius = 0;
    options.graph.skip_edges = profile == "paper" ? 2 : 0;
    options.submaps.straight = 1;
    options.loops.min_path = 1;
    return options;
}

/** Fails on the scan that is given to it. */
class Thrower : public SlamListener {
 public:
    const char* name() const override { return "thrower"; }
    void add(const SlamScan& scan) override {
        if (scan.scan.index == index) throw Error("the listener failed");
    }
    void undo() noexcept override {}

    std::size_t index = 0;
};

/** What a program makes of its options; what it puts aside is in `folder`. */
struct Drive {
    Drive(const Options& options, const std::string& folder)
        : slam(makeOdometry(options)),
          graph(std::make_shared<GraphBuilder>(options.graph)),
          loops(std::make_shared<LoopCloser>(options.submaps, options.loops, options.closures,
                                             folder, true)),
          map(std::make_shared<MapListener>(map::MapBuilder(options.map, "lidar", folder, true))) {
        for (const std::shared_ptr<SlamListener>& listener :
             std::vector<std::shared_ptr<SlamListener>>{graph, loops, map, thrower})
            slam.attach(listener);
    }
    /** What is said of a scan; of one that a listener fails on: that. */
    std::string process(const Scan& scan) {
        try {
            return test::bytesOf(slam.process(scan).step);
        } catch (const Error& error) {
            return error.what();
        }
    }

    Slam slam;
    std::shared_ptr<GraphBuilder> graph;
    std::shared_ptr<LoopCloser> loops;
    std::shared_ptr<MapListener> map;
    std::shared_ptr<Thrower> thrower = std::make_shared<Thrower>();
};

/** All that a drive leads to; it does not go on then. */
struct Result {
    Result(const Drive& drive, const Options& options)
        : state(stateOf(drive.slam)),
          poses(drive.slam.trajectory().poses),
          graph(drive.graph->graph()),
          points(drive.map->builder().build(poses).points),
          closed(drive.loops->close(graph, options.graph)),
          submaps(drive.loops->search().submaps().size()) {}

    std::string state;
    Poses poses;
    graph::PoseGraph graph;
    map::MapPoints points;
    loops::ClosedLoops closed;
    std::size_t submaps;
};

void expectSame(const Result& a, const Result& b) {
    expectSameBytes(a.poses, b.poses);
    expectSameBytes(a.graph, b.graph);
    ASSERT_EQ(a.points.size(), b.points.size());
    for (std::size_t i = 0; i < a.points.size(); ++i)
        ASSERT_EQ(a.points[i].position, b.points[i].position) << i;
    expectSameBytes(a.closed.graph, b.closed.graph);
    const auto &candidates = a.closed.candidates, &others = b.closed.candidates;
    ASSERT_EQ(candidates.size(), others.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        EXPECT_EQ(candidates[i].closure.level.matrix(), others[i].closure.level.matrix());
        EXPECT_EQ(candidates[i].closure.reason, others[i].closure.reason);
    }
}

void expectGoesOn(const Options& options, const std::vector<std::size_t>& after) {
    const auto scans = scansOf(drive(14), mounting());
    const test::TemporaryFolder first;
    Drive whole(options, first.path().string());
    whole.thrower->index = scans[8].index;  // the increment to it is counted to the next one
    std::vector<std::string> states, steps;
    for (const auto& scan : scans) {
        states.push_back(stateOf(whole.slam));
        steps.push_back(whole.process(scan));
    }
    EXPECT_EQ(steps[8], "the listener failed");
    const Result result(whole, options);
    EXPECT_GT(result.submaps, 3U);
    EXPECT_GT(result.closed.candidates.size(), 0U);
    for (const std::size_t count : after) {
        SCOPED_TRACE(count);
        // More was put aside since then.
        const test::TemporaryFolder second;
        for (const char* name : {"map.spool", "submaps.spool"})
            std::filesystem::copy_file(first / name, second / name);
        Drive again(options, second.path().string());
        again.thrower->index = scans[8].index;
        test::restore(again.slam, states[count]);
        for (std::size_t i = count; i < scans.size(); ++i)
            ASSERT_TRUE(again.process(scans[i]) == steps[i]) << i;
        expectSame(Result(again, options), result);
    }
}

TEST(SlamState, ADriveByPlanesGoesOn) { expectGoesOn(optionsOf("accurate"), {0, 1, 5, 9, 13}); }

TEST(SlamState, ADriveByThePaperGoesOn) { expectGoesOn(optionsOf("paper"), {1, 2, 7, 9}); }

TEST(SlamState, WhatIsPutAsideHasToBeThere) {
    const auto options = optionsOf("accurate");
    const auto scans = scansOf(drive(4));
    const test::TemporaryFolder folder, other;
    Drive whole(options, folder.path().string());
    for (const auto& scan : scans) whole.process(scan);
    const auto state = stateOf(whole.slam);
    EXPECT_EQ(test::refusalOf(Drive(options, folder.path().string()).slam, state), "");
    const auto missing = test::refusalOf(Drive(options, other.path().string()).slam, state);
    EXPECT_NE(missing.find(".spool"), std::string::npos) << missing;
    std::filesystem::resize_file(folder / "map.spool", 100);
    const auto shorter = test::refusalOf(Drive(options, folder.path().string()).slam, state);
    EXPECT_NE(shorter.find("map.spool"), std::string::npos) << shorter;
    EXPECT_EQ(shorter.find('\n'), std::string::npos) << shorter;
}

TEST(SlamState, FilesWithoutANameCannotBeKept) {
    const auto options = optionsOf("accurate");
    Mapping mapping(options);
    mapping.slam.process(scansOf(drive(1))[0]);
    EXPECT_THROW(stateOf(mapping.slam), Error);
}

TEST(SlamState, OtherListenersAreRefused) {
    const auto options = optionsOf("accurate");
    const test::TemporaryFolder folder;
    const Drive drive(options, folder.path().string());
    Slam bare(makeOdometry(options));
    EXPECT_NE(test::refusalOf(bare, stateOf(drive.slam)), "");
}
}  // namespace
