// Time and result of the pose graph.
//   benchmark_graph [--nodes N] [--edges M] [--loops L] [--wrong W]
// A drive of the size of KITTI's sequence 00: N poses of a vehicle that goes round a block of 800
// m, 1 m a scan, edges to the next M scans, L loop closures and W wrong edges; noise of 1 cm and
// 0.05 deg an edge, drawn with a fixed seed.
//   benchmark_graph [--profile NAME] [--set section.key=value]... DRIVE.rawlog...
// Drives with known poses (DRIVE.poses.txt and DRIVE.calib.txt beside them): errors of the edges by
// the scans that they span, and of the trajectory before and after.
#include <mrpt/system/CTicTac.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "../common/poses.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/graph/pose_graph.h"
#include "delio/odometry/odometry.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/listeners.h"
#include "delio/slam/options.h"
#include "delio/slam/slam.h"
#include "graph/residual.h"

namespace {
using namespace delio;
using Poses = std::vector<Eigen::Isometry3d>;
using test::poseAt;

constexpr double kSigma_m = 0.01, kSigma_rad = 0.05 * M_PI / 180;

class Noise {
 public:
    double operator()() { return normal_(engine_); }
    std::size_t below(std::size_t count) { return engine_() % count; }
    Eigen::Isometry3d operator()(const Eigen::Isometry3d& pose) {
        const double x = kSigma_m * (*this)(), y = kSigma_m * (*this)(), z = kSigma_m * (*this)();
        const double a = kSigma_rad * (*this)(), b = kSigma_rad * (*this)(),
                     c = kSigma_rad * (*this)();
        return pose * poseAt(x, y, z, a, b, c);
    }

 private:
    std::mt19937 engine_{1};
    std::normal_distribution<double> normal_;
};

graph::Edge edgeOf(std::size_t from, std::size_t to, const Eigen::Isometry3d& measured) {
    graph::Edge edge{from, to, {measured, Matrix6::Zero()}};
    for (int i = 0; i < 3; ++i) {
        edge.increment.covariance(i, i) = kSigma_m * kSigma_m;
        edge.increment.covariance(3 + i, 3 + i) = kSigma_rad * kSigma_rad;
    }
    return edge;
}

Poses blocks(std::size_t nodes) {
    Poses poses{Eigen::Isometry3d::Identity()};
    while (poses.size() < nodes) {
        const bool corner = poses.size() % 200 < 10;
        poses.push_back(poses.back() * poseAt(1, 0, 0, corner ? M_PI / 20 : 0));
    }
    return poses;
}

void report(const char* what, const Poses& truth, const graph::PoseGraph& graph) {
    double squares = 0, largest = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double d = test::metresBetween(truth[i], graph.poses()[i]);
        squares += d * d;
        largest = std::max(largest, d);
    }
    std::printf("  %-22s error of poses: rms %.3f m, largest %.3f m\n", what,
                std::sqrt(squares / static_cast<double>(truth.size())), largest);
}

double meanOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

void run(std::size_t nodes, std::size_t reach, std::size_t loops, std::size_t wrong) {
    const auto truth = blocks(nodes);
    Noise noise;
    graph::PoseGraph graph, driven;
    graph.addNode(truth[0]);
    driven.addNode(truth[0]);
    std::vector<double> window_ms;
    for (std::size_t i = 1; i < nodes; ++i) {
        const Eigen::Isometry3d step = noise(truth[i - 1].inverse() * truth[i]);
        graph.addNode(graph.poses().back() * step);
        graph.addEdge(edgeOf(i - 1, i, step));
        for (std::size_t k = 2; k <= std::min(reach, i); ++k)
            graph.addEdge(edgeOf(i - k, i, noise(truth[i - k].inverse() * truth[i])));
        driven.addNode(driven.poses().back() * step);
        for (auto edge = graph.edges().rbegin(); edge != graph.edges().rend() && edge->to == i;
             ++edge)
            driven.addEdge(*edge);
        mrpt::system::CTicTac clock;
        driven.optimiseLast(10, {});
        window_ms.push_back(1e3 * clock.Tac());
    }
    for (std::size_t i = 0; i < loops && nodes > 800; ++i) {
        const std::size_t from = noise.below(nodes - 800);
        const std::size_t to = from + 800 * (1 + noise.below((nodes - 1 - from) / 800));
        graph.addEdge(edgeOf(from, to, noise(truth[from].inverse() * truth[to])));
    }
    for (std::size_t i = 0; i < wrong; ++i) {
        const std::size_t from = noise.below(nodes - 1);
        graph.addEdge(
            edgeOf(from, from + 1 + noise.below(nodes - 1 - from), Eigen::Isometry3d::Identity()));
    }
    std::printf("%zu nodes, %zu edges, %zu loop closures, %zu wrong edges\n", nodes,
                graph.edges().size(), loops, wrong);
    const auto tenth = static_cast<std::ptrdiff_t>(nodes / 10);
    std::printf("  window of 10: %.2f ms a scan; of the first tenth %.2f, of the last %.2f\n",
                meanOf(window_ms), meanOf({window_ms.begin(), window_ms.begin() + tenth}),
                meanOf({window_ms.end() - tenth, window_ms.end()}));
    report("odometry", truth, graph);
    mrpt::system::CTicTac clock;
    const auto result = graph.optimise({});
    std::printf("  optimised in %.2f s, %u iterations, cost %g to %g%s\n", clock.Tac(),
                result.iterations, result.initial_cost, result.final_cost,
                result.converged ? "" : ", not converged");
    report("optimised", truth, graph);
}

/** True poses of the LiDAR, from its first one. */
Poses truePoses(const std::string& rawlog) {
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    Poses poses;
    const auto cam0 = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    for (const auto& pose : cam0)
        poses.push_back(Tr.inverse() * cam0.front().inverse() * pose * Tr);
    return poses;
}

/** Edges over `span` scans beside the odometry's way between the same scans. */
void reportEdges(const graph::PoseGraph& graph, const Poses& odometry, const Poses& truth,
                 std::size_t span) {
    std::vector<double> rotation, translation, rotationNes, translationNes;
    std::vector<double> rotationOfChain, translationOfChain;
    double both = 0, own = 0, ofChain = 0;
    for (const auto& edge : graph.edges()) {
        if (edge.to - edge.from != span) continue;
        const auto errorOf = [&](const Eigen::Isometry3d& measured) {
            return graph::residualOf(measured, truth[edge.from], truth[edge.to]).error;
        };
        const Vector6 e = errorOf(edge.increment.pose);
        const Vector6 c = errorOf(odometry[edge.from].inverse() * odometry[edge.to]);
        const Eigen::Vector3d t = e.head<3>(), w = e.tail<3>();
        const Matrix6& covariance = edge.increment.covariance;
        rotation.push_back(w.norm() * 180 / M_PI);
        translation.push_back(t.norm());
        rotationOfChain.push_back(c.tail<3>().norm() * 180 / M_PI);
        translationOfChain.push_back(c.head<3>().norm());
        rotationNes.push_back(w.dot(covariance.bottomRightCorner<3, 3>().ldlt().solve(w)));
        translationNes.push_back(t.dot(covariance.topLeftCorner<3, 3>().ldlt().solve(t)));
        both += w.dot(c.tail<3>());
        own += w.squaredNorm();
        ofChain += c.tail<3>().squaredNorm();
    }
    if (rotation.empty()) return;
    std::printf(
        "  %zu edges over %zu: rotation %.4f deg rms (chain %.4f, correlation %.2f), NES %.1f;"
        " translation %.4f m rms (chain %.4f), NES %.1f\n",
        rotation.size(), span, evaluation::spreadOf(rotation).rmse,
        evaluation::spreadOf(rotationOfChain).rmse, both / std::sqrt(own * ofChain),
        meanOf(rotationNes), evaluation::spreadOf(translation).rmse,
        evaluation::spreadOf(translationOfChain).rmse, meanOf(translationNes));
}

void reportTrajectory(const char* what, const Poses& truth, const Poses& estimate) {
    auto lengths = evaluation::kittiLengths_m();
    const double path_m = evaluation::pathLength_m(truth);
    if (path_m < 2 * lengths.front()) lengths = evaluation::suggestedLengths_m(path_m);
    const auto kitti = evaluation::kittiErrors(truth, estimate, lengths);
    const auto scan = evaluation::relativeError(truth, estimate);
    std::printf(
        "  %-24s %.3f %%, %.3f deg/100 m; a scan: %.4f m median, %.4f rms, %.4f deg median, "
        "%.4f rms\n",
        what, kitti.t_percent, kitti.r_deg_per_100m, scan.translation_m.median,
        scan.translation_m.rmse, scan.rotation_deg.median, scan.rotation_deg.rmse);
}

void run(const std::string& rawlog, Options options) {
    const auto reader = io::openScans(rawlog);
    if (reader->meta())
        options.planes.scan.vertical_correction_deg = options.paper.scan.vertical_correction_deg =
            reader->meta()->verticalCorrectionDeg;
    Slam slam(makeOdometry(options));
    const auto builder = std::make_shared<GraphBuilder>(options.graph);
    slam.attach(builder);
    const auto& poses = builder->graph().poses();
    Poses live;
    std::vector<double> graph_ms;
    while (const auto scan = reader->next()) {
        graph_ms.push_back(slam.process(*scan).listeners_ms.front().second);
        live.push_back(poses.back());
    }
    auto truth = truePoses(rawlog);
    truth.resize(live.size());
    const auto window = poses;
    const auto result = builder->optimise();
    std::printf("%s: %.0f m, %zu edges, edges and window %.1f ms a scan, cost %.0f to %.0f\n",
                rawlog.c_str(), evaluation::pathLength_m(truth), builder->graph().edges().size(),
                meanOf(graph_ms), result.initial_cost, result.final_cost);
    for (std::size_t span = 1; span <= options.graph.skip_edges + 1; ++span)
        reportEdges(builder->graph(), slam.trajectory().poses, truth, span);
    reportTrajectory("odometry", truth, slam.trajectory().poses);
    reportTrajectory("window, as driven", truth, live);
    reportTrajectory("window, after the drive", truth, window);
    reportTrajectory("optimised", truth, poses);
}
}  // namespace

int main(int argc, char** argv) try {
    std::size_t nodes = 4541, reach = 3, loops = 0, wrong = 0;
    std::string profile = "paper";
    std::vector<std::string> drives, settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto next = [&] { return std::string(++i < argc ? argv[i] : ""); };
        if (word == "--nodes")
            nodes = std::stoul(next());
        else if (word == "--edges")
            reach = std::stoul(next());
        else if (word == "--loops")
            loops = std::stoul(next());
        else if (word == "--wrong")
            wrong = std::stoul(next());
        else if (word == "--profile")
            profile = next();
        else if (word == "--set")
            settings.push_back(next());
        else
            drives.push_back(word);
    }
    if (drives.empty()) run(nodes, reach, loops, wrong);
    Options options = Options::ofProfile(profile);
    for (const auto& setting : settings) options.set(setting);
    for (const auto& drive : drives) run(drive, options);
} catch (const std::exception& e) {
    std::fprintf(stderr, "benchmark_graph: %s\n", e.what());
    return 1;
}
