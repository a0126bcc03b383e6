#include "run_table.h"

#include <mrpt/core/bits_math.h>
#include <mrpt/core/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <utility>
#include <vector>

#include "delio/core/geometry.h"
#include "delio/run/doubts.h"
#include "delio/run/summary.h"

namespace delio {
using evaluation::Comparison;
using mrpt::format;

namespace {
using Rows = std::vector<std::pair<std::string, std::string>>;

Rows rowsOf(const Comparison& found) {
    Rows rows;
    const auto& kitti = found.row.kitti;
    if (kitti.segments > 0) {
        rows.emplace_back("KITTI segments", format("%zu of %g to %g m", kitti.segments,
                                                   kitti.perLength.front().length_m,
                                                   kitti.perLength.back().length_m));
        rows.emplace_back("KITTI translation", format("%.3f %%", kitti.t_percent));
        rows.emplace_back("KITTI rotation", format("%.3f deg/100 m", kitti.r_deg_per_100m));
    }
    const double percent = found.endError_percent();
    const std::string end = format("%.3f m", found.end_error_m);
    rows.emplace_back("end error", std::isnan(percent) ? end + " (the vehicle did not move)"
                                                       : end + format(", %.2f %% of %.1f m",
                                                                      percent, found.row.length_m));
    rows.emplace_back("APE (aligned)", format("%.3f m", found.row.ape_m));
    const auto& translation = found.perScan.translation_m;
    const auto& rotation = found.perScan.rotation_deg;
    rows.emplace_back("translation per scan",
                      format("%.4f m median, %.4f m p95", translation.median, translation.p95));
    rows.emplace_back("rotation per scan",
                      format("%.4f deg median, %.4f deg p95", rotation.median, rotation.p95));
    return rows;
}
std::string georeferenceOf(const run::RunRecord& record) {
    const auto& place = *record.georeference;
    std::string text = format("%.7f, %.7f, %.2f m, heading %.2f deg", place.origin.latitude_deg,
                              place.origin.longitude_deg, place.origin.height_m,
                              earth::heading_deg(place.enuFromMap));
    const auto& gnss = record.gnss;
    if (gnss.used > 0)
        text += format(" +- %.2f; %zu of %zu fixes, RMS %.2f m", gnss.headingSigma_deg,
                       gnss.used - gnss.rejected, gnss.fixes, gnss.rms_m);
    return text;
}

std::string wheelsOf(const OdometryReport& wheels) {
    std::string text = format("%zu samples, carried %zu of %zu scans", wheels.samples,
                              wheels.scansCarried, wheels.scans);
    if (wheels.sigma)
        text += format("; scale %.4f, %.1f cm per metre", wheels.scale, 100 * *wheels.sigma);
    return text;
}

/** Of a sensor whose pose was refined; standard deviations of the worst axis. */
std::string extrinsicsOf(const run::CalibratedSensor& sensor) {
    if (!sensor.reason.empty()) return "kept as given";
    const auto pose = toMrpt(sensor.pose);
    return format("%.4f %.4f %.4f m +- %.4f, %.3f %.3f %.3f deg +- %.3f", pose.x(), pose.y(),
                  pose.z(), sensor.sigma.head<3>().maxCoeff(), mrpt::RAD2DEG(pose.yaw()),
                  mrpt::RAD2DEG(pose.pitch()), mrpt::RAD2DEG(pose.roll()),
                  mrpt::RAD2DEG(sensor.sigma.tail<3>().maxCoeff()));
}

/** Scans that were not or barely measured. */
template <typename Row>
void putDoubts(const run::RunRecord& record, const Row& row) {
    const auto doubts = run::doubtsOf(record.rows);
    const std::string axes = run::weakAxesOf(doubts);
    row("predicted", run::textOf(doubts.predicted, record.predicted()));
    row("lost", run::textOf(doubts.lost, doubts.lost.scans));
    if (const auto unlinked = run::unlinkedOf(record); unlinked.scans > 0)
        row("unlinked", run::textOf(unlinked, unlinked.scans));
    row("weakly observed",
        run::textOf(doubts.weak, doubts.weak.scans) + (axes.empty() ? "" : ", " + axes));
    if (doubts.standing.scans > 0)
        row("standing", run::textOf(doubts.standing, doubts.standing.scans));
    row("searched", run::textOf(doubts.searched, doubts.searched.scans));
    if (record.wheels) row("wheel odometry", wheelsOf(*record.wheels));
}
}  // namespace

void printTable(const run::RunRecord& record, const std::string& folder, std::ostream& out) {
    const auto row = [&](const char* name, const std::string& value) {
        out << format("%-26s %s\n", name, value.c_str());
    };
    row("scans", std::to_string(record.rows.size()));
    putDoubts(record, row);
    if (!record.fixes.empty()) {
        std::array<std::size_t, 3> scans{};
        for (const auto& fix : record.fixes) ++scans[static_cast<std::size_t>(fix.where)];
        const auto found = std::find_if(record.fixes.begin(), record.fixes.end(), isAnchor);
        std::string text =
            format("%zu scans, outside %zu, not found %zu", scans[1], scans[2], scans[0]);
        if (found != record.fixes.end())
            text +=
                format(", first found at scan %zu",
                       record.rows[static_cast<std::size_t>(found - record.fixes.begin())].scan);
        row("in the stored map", text);
    }
    for (std::size_t i = 1; i < record.extrinsics.size(); ++i)
        row(("sensor " + record.extrinsics[i].label).c_str(), extrinsicsOf(record.extrinsics[i]));
    if (record.georeference) row("georeference", georeferenceOf(record));
    if (record.extended)
        row("stored map extended", format("%zu edges of %zu candidates, %zu submaps added",
                                          static_cast<std::size_t>(std::count_if(
                                              record.joints.begin(), record.joints.end(),
                                              [](const auto& joint) { return joint.accepted(); })),
                                          record.joints.size(), record.addedSubmaps));
    if (record.update)
        row("stored map updated",
            format("%zu points gone, %zu doubted, %zu confirmed, %zu seen once",
                   record.update->gone, record.update->doubted, record.update->confirmed,
                   record.update->seenOnce));
    if (record.searchedLoops)
        row("loops", format("%zu closed of %zu candidates", record.closedLoops().size(),
                            record.loops.size()));
    row("path", format("%.1f m", record.path_m()));
    const auto latency = run::latencyOf(record.rows);
    row("time per scan", format("%.1f ms mean, %.1f ms p95, %.1f ms worst", record.msPerScan(),
                                latency[1].second, latency[2].second));
    if (record.live) {
        const auto live = run::liveFiguresOf(*record.live);
        row("latency", format("%.1f ms median, %.1f ms p99, %.1f ms worst", live[4].second,
                              live[5].second, live[6].second));
        row("packets", format("%zu, lost %zu; scans dropped %zu", record.live->sensor.packets,
                              record.live->sensor.lostPackets, record.live->sensor.droppedScans));
    }
    row("peak memory", format("%.0f MB", run::peakMemory_mb()));
    if (record.metrics && record.metricsBefore) {
        const Rows after = rowsOf(*record.metrics), before = rowsOf(*record.metricsBefore);
        out << format("%-26s %-34s %s\n", "", "optimised", "unoptimised");
        for (std::size_t i = 0; i < after.size(); ++i)
            out << format("%-26s %-34s %s\n", after[i].first.c_str(), after[i].second.c_str(),
                          before[i].second.c_str());
    } else if (record.metrics) {
        for (const auto& [name, value] : rowsOf(*record.metrics)) row(name.c_str(), value);
    }
    row("results", folder);
}

void printGraphTable(const run::RunRecord& record, const std::string& folder, std::ostream& out) {
    const auto row = [&](const char* name, const std::string& value) {
        out << format("%-26s %s\n", name, value.c_str());
    };
    const auto& result = record.optimisation;
    row("nodes", std::to_string(record.graph.poses().size()));
    row("edges", std::to_string(record.graph.edges().size()));
    row("cost", format("%.6g before, %.6g after", result.initial_cost, result.final_cost));
    row("iterations",
        std::to_string(result.iterations) + (result.converged ? "" : ", not converged"));
    row("path", format("%.1f m", record.path_m()));
    row("time", format("%.1f ms", record.optimise_ms));
    row("results", folder);
}

std::string describe(const run::RunRow& row) {
    return format("scan %zu: moved %.3f m, turned %.3f deg, %.0f ms%s%s", row.scan, row.moved_m,
                  mrpt::RAD2DEG(row.turned_rad), row.total_ms(),
                  row.predicted ? ", predicted: " : "", row.reason.c_str());
}
}  // namespace delio
