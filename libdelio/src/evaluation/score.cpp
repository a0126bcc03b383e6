#include "delio/evaluation/score.h"

#include <cmath>
#include <limits>

#include "delio/evaluation/absolute_error.h"
#include "delio/evaluation/relative_error.h"

namespace delio::evaluation {
namespace {
/** Mean of those of the rows' figures that exist. */
template <typename Figure>
double meanOf(const std::vector<ReportRow>& rows, const Figure& figure) {
    double sum = 0, count = 0;
    for (const auto& row : rows) {
        if (!std::isfinite(figure(row))) continue;
        sum += figure(row);
        ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}
}  // namespace

ReportRow score(const std::vector<Eigen::Isometry3d>& reference,
                const std::vector<Eigen::Isometry3d>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta) {
    const auto relative = relativeError(reference, estimate, delta);
    ReportRow row;
    row.length_m = pathLength_m(reference);
    row.kitti = kittiErrors(reference, estimate, lengths_m);
    row.ape_m = absoluteError(reference, estimate).rmse_m;
    row.rpe_m = relative.translation_m.rmse;
    row.rpe_deg = relative.rotation_deg.rmse;
    return row;
}

ReportRow averageOf(const std::vector<ReportRow>& rows) {
    ReportRow average;
    average.name = rows.front().name;
    average.sequence = "avg";
    for (const auto& row : rows) {
        average.length_m += row.length_m;
        average.kitti.segments += row.kitti.segments;
    }
    average.kitti.t_percent = meanOf(rows, [](const ReportRow& r) { return r.kitti.t_percent; });
    average.kitti.r_deg_per_100m =
        meanOf(rows, [](const ReportRow& r) { return r.kitti.r_deg_per_100m; });
    average.ape_m = meanOf(rows, [](const ReportRow& r) { return r.ape_m; });
    average.rpe_m = meanOf(rows, [](const ReportRow& r) { return r.rpe_m; });
    average.rpe_deg = meanOf(rows, [](const ReportRow& r) { return r.rpe_deg; });
    return average;
}
}  // namespace delio::evaluation
