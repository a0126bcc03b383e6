#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "delio/core/text.h"
#include "delio/formats/g2o.h"
#include "delio/formats/trajectory.h"
#include "delio/graph/pose_graph.h"
#include "delio/map/cloud_files.h"
#include "generators.h"
#include "test_data.h"

// What is written is what is read again.
namespace {
using namespace delio;
using namespace delio::test;

io::Trajectory drawTrajectory() {
    io::Trajectory trajectory;
    trajectory.poses = drawDrive(*rc::gen::inRange(1, 30), 1000, 180);
    double stamp_s = 1e9 * *rc::gen::inRange(0, 2);
    while (trajectory.stamps_s.size() < trajectory.poses.size())
        trajectory.stamps_s.push_back(stamp_s += *rc::gen::inRange(1, 1000) * 1e-3);
    return trajectory;
}

RC_GTEST_PROP(Formats, ADoubleIsReadAsItWasWritten, (double value)) {
    const auto read = numberIn<double>(digitsOf(value));
    RC_ASSERT(read && (*read == value || (std::isnan(*read) && std::isnan(value))));
}

RC_GTEST_PROP(Formats, TextForATerminalHasNoControlBytes, (const std::string& text)) {
    const std::string shown = printable(text);
    for (const char c : shown) RC_ASSERT(static_cast<unsigned char>(c) >= 32 && c != 127);
    RC_ASSERT(printable(shown) == shown);
}

RC_GTEST_PROP(Formats, KittisPosesAreTheSame, ()) {
    const TemporaryFolder folder;
    const auto trajectory = drawTrajectory();
    io::writeKitti(trajectory, folder / "poses.txt");
    const auto read = io::readTrajectory(folder / "poses.txt");
    RC_ASSERT(read.poses.size() == trajectory.poses.size());
    for (std::size_t i = 0; i < read.poses.size(); ++i)
        RC_ASSERT(difference(read.poses[i], trajectory.poses[i]) < 1e-12);
}

RC_GTEST_PROP(Formats, TumsPosesAreTheSame, ()) {
    const TemporaryFolder folder;
    const auto trajectory = drawTrajectory();
    io::writeTum(trajectory, folder / "poses.tum");
    const auto read = io::readTrajectory(folder / "poses.tum");
    RC_ASSERT(read.poses.size() == trajectory.poses.size());
    for (std::size_t i = 0; i < read.poses.size(); ++i) {
        RC_ASSERT(difference(read.poses[i], trajectory.poses[i]) < 1e-9);
        RC_ASSERT(std::abs(read.stamps_s[i] - trajectory.stamps_s[i]) < 1e-6);
    }
}

RC_GTEST_PROP(Formats, AGraphSavedLoadedAndSavedAgainHasTheSameBytes, ()) {
    graph::PoseGraph graph;
    for (const auto& pose : drawDrive(*rc::gen::inRange(2, 20), 10, 180)) graph.addNode(pose);
    for (std::size_t to = 1; to < graph.poses().size(); ++to) {
        Matrix6 root = Matrix6::Identity();
        for (int i = 0; i < 6; ++i) root(i, 0) += drawReal(0.5);
        graph.addEdge({to - 1, to, {drawPose(10, 180), root * root.transpose()}});
    }
    const TemporaryFolder folder;
    io::saveG2o(graph, folder / "a.g2o");
    io::saveG2o(io::loadG2o(folder / "a.g2o"), folder / "b.g2o");
    RC_ASSERT(readText(folder / "a.g2o") == readText(folder / "b.g2o"));
}

map::MapPoints drawPoints() {
    map::MapPoints points(static_cast<std::size_t>(*rc::gen::inRange(1, 50)));
    for (auto& point : points) {
        point.position = drawVector(1e5).cast<float>();
        const Eigen::Vector3d normal = drawVector(1);
        if (normal.norm() > 0) point.normal = normal.normalized().cast<float>();
        point.intensity = static_cast<float>(drawReal(255));
        point.time_s = static_cast<float>(drawReal(4000));
        point.residual_m = static_cast<float>(std::abs(drawReal(1)));
        point.observations = *rc::gen::arbitrary<std::uint16_t>();
    }
    return points;
}

void expectSame(const map::MapPoints& a, const map::MapPoints& b) {
    RC_ASSERT(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        RC_ASSERT(a[i].position == b[i].position);
        RC_ASSERT(a[i].normal == b[i].normal);
        RC_ASSERT(a[i].intensity == b[i].intensity);
        RC_ASSERT(a[i].time_s == b[i].time_s);
        RC_ASSERT(a[i].residual_m == b[i].residual_m);
        RC_ASSERT(a[i].observations == b[i].observations);
    }
}

RC_GTEST_PROP(Formats, AMapsPointsAreTheSameInPlyAndPcd, ()) {
    const TemporaryFolder folder;
    const auto points = drawPoints();
    map::savePly(points, folder / "map.ply");
    expectSame(map::loadPly(folder / "map.ply"), points);
    map::savePcd(points, folder / "map.pcd");
    expectSame(map::loadPcd(folder / "map.pcd"), points);
}
}  // namespace
