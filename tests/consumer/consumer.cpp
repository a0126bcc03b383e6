// Scans of the inside of a box, the sensor turned by 5 deg between them, through all that the
// installed library offers.  consumer OUTDIR
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>

#include "box_scan.h"
#include "delio/core/geometry.h"
#include "delio/odometry/aligner.h"
#include "delio/odometry/make_odometry.h"
#include "delio/run/run.h"
#include "delio/run/run_folder.h"
#include "delio/slam/graph_builder.h"
#include "delio/slam/slam.h"

namespace {
constexpr double kYaw = 5 * M_PI / 180;
bool allRight = true;

/** The sensor only turned, `turns` times. */
void expectTurns(const char* what, const Eigen::Isometry3d& pose, int turns = 1) {
    const Eigen::Vector3d turn = delio::rotationLog(pose.linear());
    const double metres = pose.translation().norm();
    const bool right =
        (turn - turns * kYaw * Eigen::Vector3d::UnitZ()).norm() < 0.2 * M_PI / 180 && metres < 0.02;
    std::printf("%-24s turned %.3f deg, moved %.3f m%s\n", what, turn.z() * 180 / M_PI, metres,
                right ? "" : ": wrong");
    allRight = allRight && right;
}

void expect(const char* what, bool right) {
    std::printf("%-24s %s\n", what, right ? "right" : "wrong");
    allRight = allRight && right;
}

/** An odometry alone. */
void useOdometry(const char* what, delio::Odometry& odometry) {
    odometry.process(scanAt(0, 0));
    const auto step = odometry.process(scanAt(kYaw, 1));
    expectTurns(what, step.increment.pose);
    expect("   registered", !step.predicted && step.quality.matches > 100);
}

/** An odometry with a pose graph that listens. */
void useSlam() {
    const delio::Options options;
    delio::Slam slam(delio::makeOdometry(options));
    const auto graph = std::make_shared<delio::GraphBuilder>(options.graph);
    slam.attach(graph);
    for (int i = 0; i < 3; ++i) slam.process(scanAt(i * kYaw, static_cast<std::size_t>(i)));
    graph->optimise();
    expectTurns("Slam, odometry", slam.trajectory().poses.back(), 2);
    expectTurns("Slam, pose graph", graph->graph().poses().back(), 2);
}

/** A whole run into a folder, without pictures. */
void useRun(const std::string& out) {
    delio::run::Run run(delio::Options(), {});
    for (int i = 0; i < 3; ++i) run.process(scanAt(i * kYaw, static_cast<std::size_t>(i)));
    run.finish(true);
    const delio::run::RunFolder folder(out);
    expect("Run, written", folder.write(run.record(), run.maps()).empty());
    expectTurns("Run, read back", folder.trajectory().poses.back(), 2);
    const auto summary = folder.summary();
    expect("   summary", summary.complete && summary.scans == 3 && summary.predicted == 0);
}

void useAligner() {
    const auto found =
        delio::Aligner().Align3D(scanAt(0).points.get(), scanAt(kYaw).points.get(), {});
    expectTurns("Aligner", delio::fromMrpt(found->getMeanVal()));
}
}  // namespace

int main(int argc, char** argv) try {
    if (argc != 2) {
        std::fprintf(stderr, "usage: consumer OUTDIR\n");
        return 2;
    }
    delio::PaperOdometry paper(delio::Options::ofProfile("paper").paper);
    useOdometry("PaperOdometry", paper);
    useOdometry("the default odometry", *delio::makeOdometry(delio::Options()));
    useSlam();
    useRun(argv[1]);
    useAligner();
    return allRight ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "consumer: %s\n", e.what());
    return 1;
}
