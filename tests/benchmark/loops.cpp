// How well loops close: true poses that drift as asked, and what is left of that when the loops are
// closed. DRIVE.rawlog with DRIVE.poses.txt and DRIVE.calib.txt beside it
// (share/doc/method/loops.md).
//   benchmark_loops [--drift PLANAR_PERCENT,UP_PERCENT] [--keeps METRES] [--seed N]
//                   [--list] DRIVE.rawlog...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chain.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/summary.h"
#include "slam/place_listeners.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using Poses = std::vector<Isometry3d>;

struct Settings {
    double planar = 0.005, up = 0.01;  // of the path
    double keeps_m = 100;              // path over which a drift stays what it is
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

/** Mean error of segments of 100 to 800 m, as a share of their length: planar, and of the height.
 */
std::pair<double, double> driftOf(const Poses& truth, const Poses& poses) {
    const auto path_m = evaluation::travelled_m(truth);
    double planar = 0, up = 0, segments = 0;
    for (std::size_t i = 0; i < truth.size(); i += 10)
        for (double length = 100; length <= 800; length += 100) {
            const auto end = std::lower_bound(path_m.begin(), path_m.end(), path_m[i] + length);
            if (end == path_m.end()) break;
            const auto k = static_cast<std::size_t>(end - path_m.begin());
            const Eigen::Vector3d off = (poses[i].inverse() * poses[k]).translation() -
                                        (truth[i].inverse() * truth[k]).translation();
            planar += off.head<2>().norm() / length;
            up += std::abs(off.z()) / length;
            ++segments;
        }
    return {planar / std::max(segments, 1.0), up / std::max(segments, 1.0)};
}

/** Stretched, turned and pitched by what changes over some path, as an odometry is off; turns in
 *  radians in 100 m. */
Poses drifted(const Poses& truth, const Settings& settings, double stretch, double yaw,
              double pitch) {
    std::mt19937 engine(settings.seed);
    const auto normal = [&] {
        double sum = 0;
        for (int i = 0; i < 12; ++i) sum += static_cast<double>(engine()) / 4294967296.0;
        return sum - 6;
    };
    const auto bias = [&] {
        const double a = normal(), b = normal();
        return Eigen::Vector3d(a, b, normal());
    };
    Eigen::Vector3d now = bias();
    Poses poses{truth.front()};
    for (std::size_t i = 1; i < truth.size(); ++i) {
        Isometry3d step = truth[i - 1].inverse() * truth[i];
        const double length = step.translation().norm(),
                     kept = std::exp(-length / settings.keeps_m);
        now = kept * now + std::sqrt(1 - kept * kept) * bias();
        step.translation() *= 1 + stretch * now[0];
        step.linear() = step.linear() * rotationExp({0, pitch * length / 100 * now[1],
                                                     yaw * length / 100 * now[2]});
        poses.push_back(poses.back() * step);
    }
    return poses;
}

/** With the drift that is asked for, in segments. */
Poses drifted(const Poses& truth, const Settings& settings) {
    if (evaluation::pathLength_m(truth) <= 100)
        throw Error("drift is measured in segments of 100 m and more, and this drive is shorter");
    double yaw = settings.planar, pitch = settings.up;
    Poses poses;
    for (int i = 0; i < 5; ++i) {
        poses = drifted(truth, settings, settings.planar / 2, yaw, pitch);
        const auto [planar, up] = driftOf(truth, poses);
        yaw *= settings.planar / planar;
        pitch *= settings.up / up;
    }
    return poses;
}

/** A scan within 4 m of a place that was left at least 50 m of path ago. */
struct Revisit {
    int kind = 0;  //!< 0: it is none; 1: in the same direction, 2: in the opposite one, 3: across
    std::size_t earlier = 0;
};

/** Of each scan. */
std::vector<Revisit> revisits(const Poses& truth) {
    constexpr double kNear_m = 4, kPath_m = 50;
    const auto path_m = evaluation::travelled_m(truth);
    std::vector<Revisit> found(truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i)
        for (std::size_t k = 0; k < i && path_m[i] - path_m[k] >= kPath_m; ++k) {
            const Isometry3d between = truth[k].inverse() * truth[i];
            if (between.translation().norm() > kNear_m) continue;
            const double along = between(0, 0);
            found[i] = {along > 0.7 ? 1 : along < -0.7 ? 2 : 3, k};
            break;
        }
    return found;
}

/** What loops can do at best: the same chain with the true edge of every revisit. */
Poses closedByTruth(const places::ClosedLoops& closed, const Poses& believed, const Poses& truth) {
    graph::PoseGraph graph;
    for (const auto& pose : believed) graph.addNode(pose);
    for (std::size_t i = 0; i + 1 < believed.size(); ++i) graph.addEdge(closed.graph.edges()[i]);
    Matrix6 covariance = 1e-4 * Matrix6::Identity();
    covariance.bottomRightCorner<3, 3>() *= 1e-2;
    const auto found = revisits(truth);
    for (std::size_t i = 0; i < truth.size(); i += 5) {
        if (found[i].kind == 0) continue;
        const std::size_t k = found[i].earlier;
        graph.addEdge({k, i, {truth[k].inverse() * truth[i], covariance}});
    }
    graph.optimise({});
    return graph.poses();
}

void printRecall(const places::ClosedLoops& closed, const std::vector<places::Submap>& submaps,
                 const Poses& truth) {
    const auto known = revisits(truth);
    std::size_t all[4] = {}, found[4] = {};
    for (std::size_t s = 0; s < submaps.size(); ++s) {
        bool isClosed = false;
        for (const auto& loop : closed.candidates)
            isClosed = isClosed || (loop.accepted() && loop.to == s);
        for (std::size_t i = submaps[s].first; i <= submaps[s].last; ++i) {
            const auto kind = static_cast<std::size_t>(known[i].kind);
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

void printLoops(const places::ClosedLoops& closed, const Poses& truth, bool list) {
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
                loop.fromNode, loop.toNode, loop.path_m, between.translation().norm(),
                loop.moved_m(), loop.closure.overlap, off_m, off_rad * 180 / M_PI,
                loop.closure.reason.c_str());
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
        Increment increment{Isometry3d::Identity(), 1e-6 * Matrix6::Identity()};
        if (node > 0) increment.pose = believed[node - 1].inverse() * believed[node];
        closer.add({node, *scan, step, increment, believed[node]});
        submaps_ms += watch.lap_ms();
    }
    truth.resize(node);
    const Poses used(believed.begin(), believed.begin() + static_cast<std::ptrdiff_t>(node));
    Stopwatch watch;
    const auto closed = closer.close(test::chainOf(used), {});
    const double closing_ms = watch.lap_ms(), path_m = evaluation::pathLength_m(truth);
    const auto before = evaluation::absoluteError(truth, used),
               after = evaluation::absoluteError(truth, closed.graph.poses());
    const auto best = evaluation::absoluteError(truth, closedByTruth(closed, used, truth));
    const auto [planar, up] = driftOf(truth, used);
    std::printf("%s: %zu scans, %.0f m, drift %.2f %% and %.2f %% in height, %zu submaps\n",
                rawlog.c_str(), node, path_m, 100 * planar, 100 * up,
                closer.search().submaps().size());
    printLoops(closed, truth, settings.list);
    printRecall(closed, closer.search().submaps(), truth);
    std::printf("  drift factor %.1f, cost %.4g -> %.4g in %u iterations\n", closed.drift_factor,
                closed.optimisation.initial_cost, closed.optimisation.final_cost,
                closed.optimisation.iterations);
    std::printf(
        "  APE %.3f m (at most %.3f) -> %.3f m (%.3f), %.3f %% of the path; with true edges "
        "at all revisits %.3f m\n",
        before.rmse_m, before.max_m, after.rmse_m, after.max_m, 100 * after.rmse_m / path_m,
        best.rmse_m);
    const auto kitti = [&](const Poses& poses) {
        return evaluation::kittiErrors(truth, poses).t_percent;
    };
    std::printf("  KITTI translation %.3f %% -> %.3f %%\n", kitti(used),
                kitti(closed.graph.poses()));
    const auto perScan = [&](double ms) { return ms / static_cast<double>(node); };
    std::printf(
        "  ms a scan: submaps %.2f, search %.2f beside the drive; then %.0f ms, of them %.0f "
        "for the graph; peak %.0f MB\n",
        perScan(submaps_ms), perScan(closer.search_ms()), closing_ms, closed.optimise_ms,
        run::peakMemory_mb());
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
            else if (word == "--keeps" && i + 1 < argc)
                settings.keeps_m = std::stod(argv[++i]);
            else if (word == "--drift" && i + 1 < argc) {
                const std::string drift = argv[++i];
                settings.planar = std::stod(drift) / 100;
                settings.up = std::stod(drift.substr(drift.find(',') + 1)) / 100;
            } else
                measure(word, settings);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "benchmark_loops: %s\n", e.what());
        return 1;
    }
    return 0;
}
