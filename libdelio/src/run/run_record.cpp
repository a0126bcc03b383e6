#include "delio/run/run_record.h"

#include <algorithm>

#include "delio/evaluation/metrics.h"

namespace delio::run {
std::size_t RunRecord::predicted() const {
    return static_cast<std::size_t>(std::count_if(
        rows.begin(), rows.end(), [](const RunRow& row) { return row.report.step.predicted; }));
}

bool RunRecord::isLocalised() const { return std::any_of(fixes.begin(), fixes.end(), isAnchor); }

std::vector<std::pair<std::size_t, std::size_t>> RunRecord::closedLoops() const {
    std::vector<std::pair<std::size_t, std::size_t>> nodes;
    for (const auto& loop : loops)
        if (loop.accepted()) nodes.emplace_back(loop.fromNode, loop.toNode);
    return nodes;
}

double RunRecord::path_m() const { return evaluation::pathLength_m(final.poses); }

double RunRecord::msPerScan() const {
    double sum = 0;
    for (const auto& row : rows) sum += row.total_ms();
    return rows.empty() ? 0 : sum / static_cast<double>(rows.size());
}

io::Trajectory ofSensor(const io::Trajectory& vehicle, const RunRows& rows) {
    io::Trajectory sensor = vehicle;
    if (rows.empty()) return sensor;
    const Eigen::Isometry3d first = rows.front().sensorPose.inverse();
    for (std::size_t i = 0; i < sensor.poses.size(); ++i)
        sensor.poses[i] = first * vehicle.poses[i] * rows[i].sensorPose;
    return sensor;
}
}  // namespace delio::run
