#include "report_charts.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <cmath>

#include "delio/core/numbers.h"
#include "delio/evaluation/frame_check.h"
#include "delio/evaluation/segment_curves.h"
#include "palette.h"

namespace delio::evaluation {
using mrpt::format;

namespace {
// Pose files have about six digits: smaller errors are none, and a logarithmic axis needs a floor.
constexpr double kSmallestError = 1e-6;

std::string line(const std::string& colour, double width) {
    return "with lines lc rgb '" + colour + "' lw " + digitsOf(width);
}

std::string steps(const std::string& colour) {
    return format("with steps lc rgb '%s' lw 1.6", colour.c_str());
}

std::string linesAndPoints(const std::string& colour) {
    return format("with linespoints pt 7 ps 0.6 lc rgb '%s' lw 1.6", colour.c_str());
}

/** Translation and rotation errors of segments, a chart each. */
std::vector<Chart> curveCharts(const std::vector<Group>& lines, const std::string& prefix) {
    using Curve = std::vector<CurvePoint> (*)(const std::vector<const Comparison*>&);
    struct Over {
        const char *name, *of, *axis;
        Curve curve;
    };
    const Over overs[] = {{"length", "path length", "length of the segment [m]", errorOverLength},
                          {"speed", "speed", "mean speed on the segment [km/h]", errorOverSpeed}};
    std::vector<Chart> charts;
    for (const auto& over : overs) {
        Chart translation(prefix + "translation_over_" + over.name,
                          std::string("Translation error over ") + over.of);
        Chart rotation(prefix + "rotation_over_" + over.name,
                       std::string("Rotation error over ") + over.of);
        translation.label(over.axis, "translation error [%]");
        rotation.label(over.axis, "rotation error [deg/100 m]");
        for (auto* chart : {&translation, &rotation}) chart->set("set yrange [0:*]");
        for (const auto& group : lines) {
            Chart::Rows t, r;
            for (const auto& point : over.curve(group.members)) {
                t.push_back({point.at, point.t_percent});
                r.push_back({point.at, point.r_deg_per_100m});
            }
            const std::string style = linesAndPoints(colourOf(group.estimates.front()));
            translation.curve(group.name, style, t);
            rotation.curve(group.name, style, r);
        }
        charts.push_back(std::move(translation));
        charts.push_back(std::move(rotation));
    }
    return charts;
}

/** Where the moving frame is, seen from its first pose: metres to the right, ahead and up. */
struct Place {
    double right = 0, ahead = 0, up = 0;
};

class Drawing {
 public:
    explicit Drawing(const std::vector<Eigen::Isometry3d>& reference)
        : first_(reference.front()), camera_(movesAlongZ(reference)) {}

    std::vector<Place> reference(const std::vector<Eigen::Isometry3d>& poses) const {
        return placed(poses, first_.inverse());
    }
    /** The estimate, moved so that its first pose is the true one. */
    std::vector<Place> estimate(const Comparison& comparison) const {
        return placed(comparison.estimate, first_.inverse() * comparison.reference.front() *
                                               comparison.estimate.front().inverse());
    }

 private:
    std::vector<Place> placed(const std::vector<Eigen::Isometry3d>& poses,
                              const Eigen::Isometry3d& motion) const {
        std::vector<Place> places;
        for (const auto& pose : poses) {
            const Eigen::Vector3d p = (motion * pose).translation();
            places.push_back(camera_ ? Place{p.x(), p.z(), -p.y()} : Place{-p.y(), p.x(), p.z()});
        }
        return places;
    }

    Eigen::Isometry3d first_;
    bool camera_;
};

/** The reference with most of the drive: those of TUM files may be cut to the estimate's time. */
const Comparison& longest(const Group& sequence) {
    return **std::max_element(sequence.members.begin(), sequence.members.end(),
                              [](const Comparison* a, const Comparison* b) {
                                  return a->reference.size() < b->reference.size();
                              });
}

/** The least square that holds all rows, with a margin. */
void setSquare(Chart& chart, const std::vector<Chart::Rows>& curves) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (const auto& rows : curves)
        for (const auto& row : rows)
            for (std::size_t k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], row[k]);
                high[k] = std::max(high[k], row[k]);
            }
    const double half = std::max({0.53 * (high[0] - low[0]), 0.53 * (high[1] - low[1]), 0.01});
    const char* const names[] = {"x", "y"};
    for (std::size_t k = 0; k < 2; ++k) {
        const double middle = (low[k] + high[k]) / 2;
        chart.set(std::string("set ") + names[k] + "range [" + rounded(middle - half, 9) + ':' +
                  rounded(middle + half, 9) + ']');
    }
    chart.set("set size ratio -1");
}

Chart trajectoryChart(const Group& sequence, const std::string& prefix) {
    Chart chart(prefix + "trajectory",
                "Trajectory from above, all from the first pose (circle) on");
    chart.label("to the right [m]", "ahead [m]");
    const auto seenFromAbove = [](const std::vector<Place>& places) {
        Chart::Rows rows;
        for (const auto& p : places) rows.push_back({p.right, p.ahead});
        return rows;
    };
    const auto& reference = longest(sequence).reference;
    const Drawing drawing(reference);
    std::vector<Chart::Rows> curves = {seenFromAbove(drawing.reference(reference))};
    for (const auto* estimate : sequence.members)
        curves.push_back(seenFromAbove(drawing.estimate(*estimate)));
    setSquare(chart, curves);
    chart.curve("ground truth", line(kTruthColour, 3), curves[0]);
    for (std::size_t i = 0; i < sequence.members.size(); ++i)
        chart.curve(sequence.members[i]->row.name, line(colourOf(sequence.estimates[i]), 1.4),
                    curves[i + 1]);
    chart.curve("", "with points pt 6 ps 1.2 lc rgb '#222222' lw 1.4", {curves[0].front()});
    return chart;
}

Chart heightChart(const Group& sequence, const std::string& prefix) {
    Chart chart(prefix + "height", "Height over the distance driven");
    chart.label("distance [m]", "height [m]");
    chart.set("set autoscale xfix");
    const auto overDistance = [](const std::vector<Place>& places,
                                 const std::vector<Eigen::Isometry3d>& driven) {
        const auto distance = travelled_m(driven);
        Chart::Rows rows;
        for (std::size_t i = 0; i < places.size(); ++i) rows.push_back({distance[i], places[i].up});
        return rows;
    };
    const auto& reference = longest(sequence).reference;
    const Drawing drawing(reference);
    chart.curve("ground truth", line(kTruthColour, 3),
                overDistance(drawing.reference(reference), reference));
    for (std::size_t i = 0; i < sequence.members.size(); ++i) {
        const auto& member = *sequence.members[i];
        chart.curve(member.row.name, line(colourOf(sequence.estimates[i]), 1.4),
                    overDistance(drawing.estimate(member), member.reference));
    }
    return chart;
}

/** Median of the values around each, over about a fiftieth of all. */
std::vector<double> runningMedian(const std::vector<double>& values) {
    const std::size_t reach = std::max<std::size_t>(1, values.size() / 100);
    std::vector<double> medians;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t begin = i < reach ? 0 : i - reach;
        const std::size_t end = std::min(values.size(), i + reach + 1);
        const auto at = [&](std::size_t k) {
            return values.begin() + static_cast<std::ptrdiff_t>(k);
        };
        std::vector<double> window(at(begin), at(end));
        const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
        std::nth_element(window.begin(), middle, window.end());
        medians.push_back(*middle);
    }
    return medians;
}

/** Shares of the errors in ten bins a decade, drawn as steps. */
Chart::Rows histogram(const std::vector<double>& errors) {
    constexpr int kBinsPerDecade = 10;
    if (errors.empty()) return {};
    const auto binOf = [](double error) {
        return static_cast<int>(
            std::floor(kBinsPerDecade * std::log10(std::max(error, kSmallestError)) + 1e-9));
    };
    const auto [least, most] = std::minmax_element(errors.begin(), errors.end());
    const int first = binOf(*least), last = binOf(*most);
    std::vector<double> shares(static_cast<std::size_t>(last - first + 1));
    for (const double error : errors)
        shares[static_cast<std::size_t>(binOf(error) - first)] +=
            100 / static_cast<double>(errors.size());
    const auto edge = [&](int bin) { return std::pow(10, double(bin) / kBinsPerDecade); };
    Chart::Rows rows = {{edge(first), 0}};  // a step begins at its own x
    for (int bin = first; bin <= last; ++bin)
        rows.push_back({edge(bin), shares[static_cast<std::size_t>(bin - first)]});
    rows.push_back({edge(last + 1), 0});
    return rows;
}

/** Errors of the motion from scan to scan. */
struct StepErrors {
    const Comparison* comparison;
    std::size_t estimate;
    std::vector<double> errors;
};

Chart overTimeChart(const std::vector<StepErrors>& all, const std::string& name,
                    const std::string& what, const std::string& unit) {
    const bool anyPredicted = std::any_of(all.begin(), all.end(), [](const StepErrors& e) {
        const auto& flags = e.comparison->predicted;
        return std::find(flags.begin(), flags.end(), true) != flags.end();
    });
    Chart chart(
        name,
        what + " error from scan to scan, and its running median" +
            (anyPredicted ? "; triangles are scans that were predicted, not registered" : ""));
    chart.set("set autoscale xfix");
    const bool assumed = std::any_of(
        all.begin(), all.end(), [](const StepErrors& e) { return e.comparison->timesAreAssumed; });
    chart.label(assumed ? "time, at ten scans a second [s]" : "time [s]",
                "error [" + unit + "], log. scale");
    chart.set("set logscale y");
    chart.set("set format y '%g'");
    const auto rowsOf = [](const StepErrors& own, const std::vector<double>& errors,
                           bool onlyPredicted) {
        Chart::Rows rows;
        for (std::size_t i = 0; i < errors.size(); ++i)
            if (!onlyPredicted || own.comparison->predicted[i + 1])
                rows.push_back(
                    {own.comparison->times_s[i + 1], std::max(errors[i], kSmallestError)});
        return rows;
    };
    for (const auto& own : all)
        chart.curve("", line(paleColourOf(own.estimate), 0.5), rowsOf(own, own.errors, false));
    for (const auto& own : all)
        chart.curve(own.comparison->row.name, line(colourOf(own.estimate), 1.6),
                    rowsOf(own, runningMedian(own.errors), false));
    std::string title = "predicted";  // once in the key, in whatever colour comes first
    for (const auto& own : all) {
        if (own.comparison->predicted.empty()) continue;
        const auto rows = rowsOf(own, own.errors, true);
        chart.curve(title, "with points pt 9 ps 0.9 lc rgb '" + colourOf(own.estimate) + "'", rows);
        if (!rows.empty()) title.clear();
    }
    return chart;
}

Chart histogramChart(const std::vector<StepErrors>& all, const std::string& name,
                     const std::string& what, const std::string& unit) {
    Chart chart(name,
                what + " error from scan to scan: share of the scans in each tenth of a decade");
    chart.label("error [" + unit + "], log. scale", "scans [%]");
    chart.set("set logscale x");
    chart.set("set format x '%g'");
    chart.set("set yrange [0:*]");
    for (const auto& own : all)
        chart.curve(own.comparison->row.name, steps(colourOf(own.estimate)), histogram(own.errors));
    return chart;
}
}  // namespace

std::vector<Chart> overviewCharts(const std::vector<Group>& byEstimate) {
    return curveCharts(byEstimate, "all_");
}

std::vector<Chart> sequenceCharts(const Group& sequence, const std::string& prefix) {
    std::vector<Chart> charts = {trajectoryChart(sequence, prefix), heightChart(sequence, prefix)};
    std::vector<Group> lines;
    std::vector<StepErrors> translation, rotation;
    for (std::size_t i = 0; i < sequence.members.size(); ++i) {
        const auto* member = sequence.members[i];
        const std::size_t estimate = sequence.estimates[i];
        lines.push_back({member->row.name, {member}, {estimate}});
        translation.push_back({member, estimate, member->perScan.translations_m});
        rotation.push_back({member, estimate, member->perScan.rotations_deg});
    }
    for (auto& chart : curveCharts(lines, prefix)) charts.push_back(std::move(chart));
    charts.push_back(
        overTimeChart(translation, prefix + "translation_over_time", "Translation", "m"));
    charts.push_back(overTimeChart(rotation, prefix + "rotation_over_time", "Rotation", "deg"));
    charts.push_back(
        histogramChart(translation, prefix + "translation_histogram", "Translation", "m"));
    charts.push_back(histogramChart(rotation, prefix + "rotation_histogram", "Rotation", "deg"));
    return charts;
}
}  // namespace delio::evaluation
