#include "scan_row.h"

#include <string>

#include "delio/core/numbers.h"

namespace delio::run {
namespace {
/** Axes that were not observed, each as "x y z". */
std::string axesText(const Eigen::Matrix3Xd& axes) {
    std::string text;
    for (Eigen::Index i = 0; i < axes.cols(); ++i)
        text += (i > 0 ? "; " : "") + fixed(axes(0, i), 3) + ' ' + fixed(axes(1, i), 3) + ' ' +
                fixed(axes(2, i), 3);
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
    put("read_ms", fixed(row.read_ms, 3));
    for (const auto& [stage, ms] : step.times_ms) put(std::string(stage) + "_ms", fixed(ms, 3));
    for (const auto& [listener, ms] : row.report.listeners_ms)
        put(std::string(listener) + "_ms", fixed(ms, 3));
    for (const auto& [name, value] : step.details) put(name, rounded(value, 9));
    const Quality& quality = step.quality;
    put("matches", std::to_string(quality.matches));
    put("residual_m", rounded(quality.residual_m, 9));
    for (int k = 0; k < 3; ++k)
        put("rotation_observability_" + std::to_string(k + 1),
            rounded(quality.rotationObservability[k], 9));
    for (int k = 0; k < 3; ++k)
        put("translation_observability_" + std::to_string(k + 1),
            rounded(quality.translationObservability[k], 9));
    put("rotation_unobserved", axesText(quality.unobservedRotation));
    put("translation_unobserved", axesText(quality.unobservedTranslation));
    put("searched", step.searched ? "1" : "0");
    put("interrupted", step.interrupted ? "1" : "0");
    put("standing", step.standing ? "1" : "0");
    return cells;
}
}  // namespace delio::run
