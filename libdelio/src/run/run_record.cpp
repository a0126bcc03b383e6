#include "delio/run/run_record.h"

#include <algorithm>
#include <utility>

#include "delio/core/geometry.h"
#include "delio/evaluation/metrics.h"

namespace delio::run {
namespace {
std::vector<std::string> namesOf(const std::vector<Named>& figures) {
    std::vector<std::string> names;
    names.reserve(figures.size());
    for (const auto& figure : figures) names.push_back(figure.first);
    return names;
}

std::vector<Named> named(const std::vector<std::string>& names, const double* values) {
    std::vector<Named> figures;
    figures.reserve(names.size());
    for (const auto& name : names) figures.emplace_back(name, *values++);
    return figures;
}
}  // namespace

RowFigures::RowFigures(const ScanReport& report, const RowFigures& before) {
    Names names{namesOf(report.step.times_ms), namesOf(report.listeners_ms),
                namesOf(report.step.details)};
    const bool isSame = before.names_ && names.stages == before.names_->stages &&
                        names.listeners == before.names_->listeners &&
                        names.details == before.names_->details;
    names_ = isSame ? before.names_ : std::make_shared<const Names>(std::move(names));
    values_.reserve(names_->stages.size() + names_->listeners.size() + names_->details.size());
    for (const auto* figures : {&report.step.times_ms, &report.listeners_ms, &report.step.details})
        for (const auto& figure : *figures) values_.push_back(figure.second);
}

std::vector<Named> RowFigures::stages_ms() const {
    return names_ ? named(names_->stages, values_.data()) : std::vector<Named>();
}

std::vector<Named> RowFigures::listeners_ms() const {
    if (!names_) return {};
    return named(names_->listeners, values_.data() + names_->stages.size());
}

std::vector<Named> RowFigures::details() const {
    if (!names_) return {};
    return named(names_->details,
                 values_.data() + names_->stages.size() + names_->listeners.size());
}

double RunRow::total_ms() const {
    double sum = read_ms;
    for (const auto& stage : figures.stages_ms()) sum += stage.second;
    for (const auto& [listener, ms] : figures.listeners_ms())
        if (listener != "map") sum += ms;
    return sum;
}

RunRow rowOf(const Scan& scan, const ScanReport& report, double read_ms, const RunRow* before) {
    const Step& step = report.step;
    RunRow row;
    row.scan = scan.index;
    row.stamp_s = scan.stamp_s;
    row.sensorPose = scan.sensorPose;
    row.points = step.used.indices.size();
    row.notFinite = step.notFinite;
    row.read_ms = read_ms;
    row.moved_m = step.increment.pose.translation().norm();
    row.turned_rad = angleOf(step.increment.pose.linear());
    row.predicted = step.predicted;
    row.lost = step.lost;
    row.track = step.track;
    row.carried = step.carried;
    row.searched = step.searched;
    row.interrupted = step.interrupted;
    row.standing = step.standing;
    row.deskewed = step.deskewed;
    row.reason = step.reason;
    row.quality = step.quality;
    row.figures = RowFigures(report, before ? before->figures : RowFigures());
    return row;
}

std::size_t RunRecord::predicted() const {
    return static_cast<std::size_t>(
        std::count_if(rows.begin(), rows.end(), [](const RunRow& row) { return row.predicted; }));
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

io::Trajectory ofSensor(const io::Trajectory& vehicle, const std::vector<RunRow>& rows) {
    io::Trajectory sensor = vehicle;
    if (rows.empty()) return sensor;
    const Eigen::Isometry3d first = rows.front().sensorPose.inverse();
    for (std::size_t i = 0; i < sensor.poses.size(); ++i)
        sensor.poses[i] = first * vehicle.poses[i] * rows[i].sensorPose;
    return sensor;
}
}  // namespace delio::run
