#include "delio/run/run_rows.h"

#include <algorithm>
#include <string_view>

namespace delio::run {
namespace {
std::vector<std::string> namesOf(const std::vector<Named>& figures) {
    std::vector<std::string> names;
    names.reserve(figures.size());
    for (const auto& figure : figures) names.push_back(figure.first);
    return names;
}

/** The place of `value` among the last values of the list; a new one is appended. Looking at all
 *  would take the square of the rows where each has another value. */
template <typename Value, typename IsSame>
double placeIn(std::vector<Value>& list, const Value& value, const IsSame& isSame) {
    constexpr std::ptrdiff_t kLast = 64;
    const auto end = list.size() > kLast ? list.rbegin() + kLast : list.rend();
    const auto found =
        std::find_if(list.rbegin(), end, [&](const Value& other) { return isSame(other, value); });
    if (found != end) return static_cast<double>(list.rend() - found - 1);
    list.push_back(value);
    return static_cast<double>(list.size() - 1);
}

/** Numbers one after the other, as they were put. */
class Cursor {
 public:
    Cursor(const Chunked<double>& numbers, std::size_t at) : numbers_(numbers), at_(at) {}

    double number() { return numbers_[at_++]; }
    std::size_t count() { return static_cast<std::size_t>(number()); }
    bool flag() { return number() != 0; }
    std::vector<Named> figures(const std::vector<std::string>& names) {
        std::vector<Named> result;
        result.reserve(names.size());
        for (const auto& name : names) result.emplace_back(name, number());
        return result;
    }
    Eigen::Matrix3Xd columns() {
        Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(count()));
        for (double& value : result.reshaped()) value = number();
        return result;
    }

 private:
    const Chunked<double>& numbers_;
    std::size_t at_;
};
}  // namespace

double RunRow::total_ms() const {
    double sum = read_ms;
    for (const auto& [stage, ms] : report.step.times_ms) sum += ms;
    for (const auto& [listener, ms] : report.listeners_ms)
        if (std::string_view(listener) != "map") sum += ms;
    return sum;
}

void RunRows::put(const std::vector<Named>& figures) {
    for (const auto& figure : figures) put(figure.second);
}

void RunRows::put(const Eigen::Ref<const Eigen::Matrix3Xd>& columns) {
    put(static_cast<double>(columns.cols()));
    for (const double value : columns.reshaped()) put(value);
}

void RunRows::push_back(const RunRow& row) {
    const Step& step = row.report.step;
    const Quality& quality = step.quality;
    const Names names{namesOf(step.times_ms), namesOf(row.report.listeners_ms),
                      namesOf(step.details)};
    begins_.push_back(numbers_.size());
    put(placeIn(names_, names, std::equal_to<>()));
    put(placeIn(reasons_, step.reason, std::equal_to<>()));
    put(placeIn(sensorPoses_, row.sensorPose,
                [](const auto& a, const auto& b) { return a.matrix() == b.matrix(); }));
    for (const std::size_t count : {row.scan, row.points, step.notFinite, quality.matches})
        put(static_cast<double>(count));
    for (const double number : {row.stamp_s, row.read_ms, quality.residual_m}) put(number);
    for (const bool flag :
         {step.predicted, step.searched, step.interrupted, step.standing, step.deskewed})
        put(flag);
    put(step.times_ms);
    put(row.report.listeners_ms);
    put(step.details);
    put(quality.rotationObservability);
    put(quality.translationObservability);
    put(quality.unobservedRotation);
    put(quality.unobservedTranslation);
}

RunRow RunRows::operator[](std::size_t i) const {
    RunRow row;
    Step& step = row.report.step;
    Quality& quality = step.quality;
    Cursor next(numbers_, begins_[i]);
    const Names& names = names_[next.count()];
    step.reason = reasons_[next.count()];
    row.sensorPose = sensorPoses_[next.count()];
    for (std::size_t* count : {&row.scan, &row.points, &step.notFinite, &quality.matches})
        *count = next.count();
    for (double* number : {&row.stamp_s, &row.read_ms, &quality.residual_m})
        *number = next.number();
    for (bool* flag :
         {&step.predicted, &step.searched, &step.interrupted, &step.standing, &step.deskewed})
        *flag = next.flag();
    step.times_ms = next.figures(names.stages);
    row.report.listeners_ms = next.figures(names.listeners);
    step.details = next.figures(names.details);
    quality.rotationObservability = next.columns();
    quality.translationObservability = next.columns();
    quality.unobservedRotation = next.columns();
    quality.unobservedTranslation = next.columns();
    return row;
}
}  // namespace delio::run
