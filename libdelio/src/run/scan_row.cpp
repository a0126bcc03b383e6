#include "scan_row.h"

#include <mrpt/core/format.h>

namespace delio::run {
using mrpt::format;

namespace {
/** Axes that were not observed, each as "x y z". */
std::string axesText(const Eigen::Matrix3Xd& axes) {
    std::string text;
    for (Eigen::Index i = 0; i < axes.cols(); ++i)
        text += format("%s%.3f %.3f %.3f", i > 0 ? "; " : "", axes(0, i), axes(1, i), axes(2, i));
    return text;
}

}  // namespace

io::ScanRow scanRowOf(const RunRow& row) {
    const Step& step = row.report.step;
    io::ScanRow cells{row.scan, row.stamp_s, {}, step.predicted, step.reason};
    const auto put = [&](const std::string& name, const std::string& value) {
        cells.values.emplace_back(name, value);
    };
    put("points", std::to_string(row.points));
    put("not_finite", std::to_string(step.notFinite));
    put("read_ms", format("%.3f", row.read_ms));
    for (const auto& [stage, ms] : step.times_ms)
        put(std::string(stage) + "_ms", format("%.3f", ms));
    for (const auto& [listener, ms] : row.report.listeners_ms)
        put(std::string(listener) + "_ms", format("%.3f", ms));
    for (const auto& [name, value] : step.details) put(name, format("%.9g", value));
    const Quality& quality = step.quality;
    put("matches", std::to_string(quality.matches));
    put("residual_m", format("%.9g", quality.residual_m));
    for (int k = 0; k < 3; ++k)
        put(format("rotation_observability_%d", k + 1),
            format("%.9g", quality.rotationObservability[k]));
    for (int k = 0; k < 3; ++k)
        put(format("translation_observability_%d", k + 1),
            format("%.9g", quality.translationObservability[k]));
    put("rotation_unobserved", axesText(quality.unobservedRotation));
    put("translation_unobserved", axesText(quality.unobservedTranslation));
    put("searched", step.searched ? "1" : "0");
    put("interrupted", step.interrupted ? "1" : "0");
    put("standing", step.standing ? "1" : "0");
    return cells;
}
}  // namespace delio::run
