// How well loops close: true poses that drift as asked, and what is left of that when the loops are
// closed. DRIVE.rawlog with DRIVE.poses.txt and DRIVE.calib.txt beside it (share/doc/loops.md).
//   benchmark_loops [--drift PLANAR_PERCENT,DEG_PER_100M] [--seed N] [--list] DRIVE.rawlog...
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/evaluation/absolute_error.h"
#include "delio/evaluation/kitti_metric.h"
#include "delio/io/drive_meta.h"
#include "delio/io/scan_reader.h"
#include "delio/io/trajectory.h"
#include "delio/slam/loop_closer.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using Poses = std::vector<Isometry3d>;

struct Settings {
    double planar = 0.005, deg_per_100m = 0.6;
    unsigned seed = 1;
    bool list = false;
};

Poses truePoses(const std::string& rawlog) {
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    Poses poses = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    const Isometry3d first = poses.front();
    for (auto& pose : poses) pose = Tr.inverse() * first.inverse() * pose * Tr;
    return poses;
}

/** Stretched, turned and pitched by what changes over some 100 m, as an odometry is off. */
Poses drifted(const Poses& truth, const Settings& settings) {
    constexpr double kLength_m = 100;
    std::mt19937 engine(settings.seed);
    const auto normal = [&] {
        double sum = 0;
        for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine()) / 4294967296.0;
        return sum - 6;
    };
    Eigen::Vector3d bias(normal(), normal(), normal());
    Poses poses{truth.front()};
    for (std::size_t i = 1; i < truth.size(); ++i) {
        Isometry3d step = truth[i - 1].inverse() * truth[i];
        const double length = step.translation().norm(), kept = std::exp(-length / kLength_m),
                     turn = settings.deg_per_100m * M_PI / 180 * length / 100;
        bias = kept * bias +
               std::sqrt(1 - kept * kept) * Eigen::Vector3d(normal(), normal(), normal());
        step.translation() *= 1 + settings.planar * bias[0];
        step.linear() = step.linear() * rotationExp({0, turn * bias[1], turn * bias[2]});
        poses.push_back(poses.back() * step);
    }
    return poses;
}

graph::PoseGraph chainOf(const Poses& poses) {
    graph::PoseGraph graph;
    for (const auto& pose : poses) graph.addNode(pose);
    for (std::size_t i = 1; i < poses.size(); ++i) {
        Increment step{poses[i - 1].inverse() * poses[i], Matrix6::Identity()};
        step.covariance.diagonal() << 1e-6, 1e-6, 1e-6, 1e-9, 1e-9, 1e-9;
        graph.addEdge({i - 1, i, step});
    }
    return graph;
}

/** Nodes that come within 4 m of a place left at least 50 m of path ago: 0 none, 1 in the same
 *  direction, 2 in the opposite one, 3 across. */
std::vector<int> revisits(const Poses& truth) {
    constexpr double kNear_m = 4, kPath_m = 50;
    std::vector<double> path_m{0};
    std::vector<int> kinds(truth.size(), 0);
    for (std::size_t i = 1; i < truth.size(); ++i)
        path_m.push_back(path_m.back() +
                         (truth[i].translation() - truth[i - 1].translation()).norm());
    for (std::size_t i = 0; i < truth.size(); ++i)
        for (std::size_t k = 0; k < i && path_m[i] - path_m[k] >= kPath_m; ++k) {
            const Isometry3d between = truth[k].inverse() * truth[i];
            if (between.translation().norm() > kNear_m) continue;
            const double along = between(0, 0);
            kinds[i] = along > 0.7 ? 1 : along < -0.7 ? 2 : 3;
            break;
        }
    return kinds;
}

void printRecall(const loops::ClosedLoops& closed, const std::vector<loops::Submap>& submaps,
                 const Poses& truth) {
    const auto kinds = revisits(truth);
    std::size_t all[4] = {}, found[4] = {};
    for (std::size_t s = 0; s < submaps.size(); ++s) {
        bool isClosed = false;
        for (const auto& loop : closed.candidates)
            isClosed = isClosed || (loop.accepted() && loop.to == s);
        for (std::size_t i = submaps[s].first; i <= submaps[s].last; ++i) {
            const auto kind = static_cast<std::size_t>(kinds[i]);
            ++all[kind];
            found[kind] += isClosed;
        }
    }
    const char* names[] = {"", "same direction", "opposite", "across"};
    for (std::size_t kind = 1; kind < 4; ++kind)
        if (all[kind] > 0)
            std::printf("  revisits, %-15s %5zu scans, %5.1f %% closed\n", names[kind], all[kind],
                        100.0 * static_cast<double>(found[kind]) / static_cast<double>(all[kind]));
}

void printLoops(const loops::ClosedLoops& closed, const Poses& truth, bool list) {
    constexpr double kWrong_m = 0.5, kWrong_rad = M_PI / 180;
    std::size_t wrong = 0;
    for (const auto& loop : closed.candidates) {
        const Isometry3d between = truth[loop.fromNode].inverse() * truth[loop.toNode],
                         off = between.inverse() * loop.closure.increment.pose;
        const double off_m = off.translation().norm(), off_rad = angleOf(off.linear());
        wrong += loop.accepted() && (off_m > kWrong_m || off_rad > kWrong_rad);
        if (list)
            std::printf(
                "    %5zu %5zu %6.0f m apart %5.1f m moved %5.1f m overlap %.2f: off %.3f m "
                "%.3f deg %s\n",
                loop.fromNode, loop.toNode, loop.path_m, between.translation().norm(), loop.moved_m,
                loop.closure.overlap, off_m, off_rad * 180 / M_PI, loop.closure.reason.c_str());
    }
    std::printf("  loops closed %zu of %zu candidates, wrong (%.1f m, %.0f deg) %zu\n",
                closed.accepted, closed.candidates.size(), kWrong_m, kWrong_rad * 180 / M_PI,
                wrong);
}

void measure(const std::string& rawlog, const Settings& settings) {
    Poses truth = truePoses(rawlog);
    const Poses believed = drifted(truth, settings);
    LoopCloser closer({}, {}, {});
    const auto reader = io::openScans(rawlog);
    std::size_t node = 0;
    double submaps_ms = 0;
    for (auto scan = reader->next(); scan && node < truth.size(); scan = reader->next(), ++node) {
        Step step;
        const auto& points = *scan->points;
        step.used.points.resize(3, static_cast<Eigen::Index>(points.size()));
        Eigen::Index count = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            Eigen::Vector3f point;
            points.getPointFast(i, point.x(), point.y(), point.z());
            if (point.allFinite()) step.used.points.col(count++) = point;
        }
        step.used.points.conservativeResize(3, count);
        Stopwatch watch;
        closer.add({node, *scan, step, {}, believed[node]});
        submaps_ms += watch.lap_ms();
    }
    truth.resize(node);
    const Poses used(believed.begin(), believed.begin() + static_cast<std::ptrdiff_t>(node));
    Stopwatch watch;
    const auto closed = closer.close(chainOf(used), {});
    const double closing_ms = watch.lap_ms(), path_m = evaluation::pathLength_m(truth);
    const auto before = evaluation::absoluteError(truth, used),
               after = evaluation::absoluteError(truth, closed.graph.poses());
    std::printf("%s: %zu scans, %.0f m, %zu submaps\n", rawlog.c_str(), node, path_m,
                closer.submaps().size());
    printLoops(closed, truth, settings.list);
    printRecall(closed, closer.submaps(), truth);
    std::printf("  drift factor %.1f, cost %.4g -> %.4g in %u iterations\n", closed.drift_factor,
                closed.optimisation.initial_cost, closed.optimisation.final_cost,
                closed.optimisation.iterations);
    std::printf("  APE %.3f m (at most %.3f) -> %.3f m (%.3f), %.3f %% of the path\n",
                before.rmse_m, before.max_m, after.rmse_m, after.max_m,
                100 * after.rmse_m / path_m);
    std::printf("  ms a scan: submaps %.2f, search and graph %.2f\n",
                submaps_ms / static_cast<double>(node), closing_ms / static_cast<double>(node));
}
}  // namespace

int main(int argc, char** argv) {
    try {
        Settings settings;
        for (int i = 1; i < argc; ++i) {
            const std::string word = argv[i];
            if (word == "--list")
                settings.list = true;
            else if (word == "--seed" && i + 1 < argc)
                settings.seed = static_cast<unsigned>(std::stoul(argv[++i]));
            else if (word == "--drift" && i + 1 < argc) {
                const std::string drift = argv[++i];
                settings.planar = std::stod(drift) / 100;
                settings.deg_per_100m = std::stod(drift.substr(drift.find(',') + 1));
            } else
                measure(word, settings);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "benchmark_loops: %s\n", e.what());
        return 1;
    }
    return 0;
}
