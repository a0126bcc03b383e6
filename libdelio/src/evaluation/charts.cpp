#include "evaluation/charts.h"

#include <fcntl.h>
#include <mrpt/core/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/evaluation/comparison.h"
#include "delio/files/output.h"

namespace delio::evaluation {
namespace fs = std::filesystem;
using mrpt::format;

namespace {
constexpr std::size_t kLongestTitle = 32;  // characters; longer ones push the key off the plot

/** Quoted gnuplot string. Special characters (quotes, backquotes, backslashes ...) are written as
 *  character codes. */
std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        const bool plain = code >= 0x80 || std::isalnum(code) != 0 ||
                           std::string(" -_.,:;/()[]%<>&").find(c) != std::string::npos;
        result += plain ? std::string(1, c) : mrpt::format("\\%03o", code);
    }
    return result + "\"";
}

/** The first characters of a long text. */
std::string shortened(const std::string& text) {
    std::size_t characters = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if ((static_cast<unsigned char>(text[i]) & 0xC0) == 0x80) continue;  // inside of one
        if (++characters > kLongestTitle) return text.substr(0, i) + "...";
    }
    return text;
}

/** Runs a program in `folder`, its stderr written to `log`; its exit code, or -1 if there is no
 *  such program. */
int run(const std::vector<std::string>& words, const std::string& folder, const std::string& log) {
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    pid_t child = 0;
    const int fault = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (fault == ENOENT) return -1;
    if (fault != 0) throw Error("cannot run " + words[0] + ": " + std::strerror(fault));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/** Reason of gnuplot's failure: its last non-empty line. */
std::string lastLine(const std::string& file) {
    std::ifstream in(file);
    std::string last;
    for (std::string line; std::getline(in, line);)
        if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    return last.substr(std::min(last.find_first_not_of(" \t"), last.size()));
}

constexpr std::array<unsigned, 8> kColours = {0x0072b2, 0xe69f00, 0x009e73, 0xaa4499,
                                              0x56b4e9, 0x6b4c1e, 0x222222, 0x999933};

constexpr std::size_t kFewest = 3;    // segments that make a point
constexpr double kSpeedStep_mps = 2;  // between points, and half of what one covers
constexpr double kTooFast_mps = 2e3;  // stamps that nearly coincide

void append(std::vector<CurvePoint>& curve, double at, const std::vector<Segment>& segments) {
    if (segments.size() < kFewest) return;
    const auto mean = meanOf(segments);
    curve.push_back({at, mean.t_percent, mean.r_deg_per_100m});
}

// Pose files have about six digits, so smaller errors are meaningless; a logarithmic axis needs a
// minimum.
constexpr double kSmallestError = 1e-6;

std::string line(const std::string& colour, double width) {
    return "with lines lc rgb '" + colour + "' lw " + digitsOf(width);
}

std::string linesAndPoints(const std::string& colour) {
    return format("with linespoints pt 7 ps 0.6 lc rgb '%s' lw 1.6", colour.c_str());
}

/** Position relative to the first pose: metres to the right, forward and up. */
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
    Chart chart(prefix + "trajectory", "Trajectory from above, aligned at the first pose (circle)");
    chart.label("right [m]", "forward [m]");
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
    Chart chart(prefix + "height", "Height over travelled distance");
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
    Chart chart(name, what + " error per scan, and its running median" +
                          (anyPredicted ? "; triangles: predicted scans" : ""));
    chart.set("set autoscale xfix");
    const bool assumed = std::any_of(
        all.begin(), all.end(), [](const StepErrors& e) { return e.comparison->timesAreAssumed; });
    chart.label(assumed ? "time, assuming 10 scans per second [s]" : "time [s]",
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
        chart.curve("", line("#ad" + colourOf(own.estimate).substr(1), 0.5),
                    rowsOf(own, own.errors, false));
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

}  // namespace

Chart::Chart(std::string name, std::string caption)
    : name_(std::move(name)), caption_(std::move(caption)) {}

void Chart::label(const std::string& x, const std::string& y) {
    set("set xlabel " + quoted(x));
    set("set ylabel " + quoted(y));
}

void Chart::set(const std::string& command) { settings_ += command + "\n"; }

void Chart::curve(const std::string& title, const std::string& style, const Rows& rows) {
    if (rows.empty()) return;
    const std::string shown = shortened(printable(title));
    data_ += (curves_.empty() ? "# " : "\n\n# ") + printable(title) + "\n";
    for (const auto& row : rows) {
        const char* separator = "";
        for (const double value : row) {
            data_ += separator + rounded(value, 9);
            separator = " ";
        }
        data_ += "\n";
    }
    curves_.push_back(quoted(name_ + ".dat") + " index " + std::to_string(curves_.size()) + " " +
                      style + (shown.empty() ? " notitle" : " title " + quoted(shown)));
}

std::string Chart::script() const {
    std::string plot;
    for (const auto& curve : curves_) plot += (plot.empty() ? "plot " : ", \\\n     ") + curve;
    // Both terminals draw the same picture; the PNG has two pixels for each of the SVG's units.
    return "# 'gnuplot " + name_ + ".gp', in this folder, draws " + name_ + ".svg and " + name_ +
           ".png of " + name_ +
           ".dat.\n"
           "reset session\n"
           "set encoding utf8\n"
           "set border 3 lc rgb '#666666'\n"
           "set tics nomirror textcolor rgb '#333333'\n"
           // gnuplot's own has five decimals: neighbouring ticks may read the same.
           "set format '%.10g'\n"
           "set grid lc rgb '#cccccc' lw 0.5 lt 1\n"
           "set key outside top center horizontal Left reverse samplen 1.6\n" +
           settings_ +
           "set terminal svg size 560,420 noenhanced font 'sans-serif,15' lw 1.5 "
           "background '#ffffff'\n"
           "set output '" +
           name_ + ".svg'\n" + plot +
           "\nset terminal pngcairo size 1120,840 noenhanced font 'sans-serif,11' fontscale 2 "
           "lw 3 pointscale 2 background '#ffffff'\n"
           "set output '" +
           name_ + ".png'\nreplot\nset output\n";
}

void drawCharts(const std::vector<Chart>& charts, const std::string& folder) {
    // "-d": whatever the user's ~/.gnuplot says.
    std::vector<std::string> words = {"gnuplot", "-d"};
    for (const auto& chart : charts) {
        const std::string base = (fs::path(folder) / chart.name()).string();
        io::replaceTextFile(base + ".dat", [&](std::ostream& out) { out << chart.data(); });
        io::replaceTextFile(base + ".gp", [&](std::ostream& out) { out << chart.script(); });
        words.push_back(chart.name() + ".gp");
    }
    if (charts.empty()) words.emplace_back("--version");  // it has to be there all the same
    const std::string log = (fs::absolute(folder) / "gnuplot.log").string();
    const int exitCode = run(words, folder, log);
    const std::string reason = exitCode == 0 ? "" : lastLine(log);
    std::error_code ignored;
    fs::remove(log, ignored);
    if (exitCode == -1)
        throw Error("the report needs gnuplot; install it with: apt-get install gnuplot-nox");
    bool all = exitCode == 0;
    for (const auto& chart : charts)
        for (const char* extension : {".svg", ".png"}) {
            std::error_code fault;
            const auto size = fs::file_size(fs::path(folder) / (chart.name() + extension), fault);
            all = all && !fault && size > 0;
        }
    if (!all)
        throw Error("gnuplot failed" + (reason.empty() ? ": the disk may be full" : ": " + reason));
}

std::string colourOf(std::size_t estimate) {
    return mrpt::format("#%06x", kColours[estimate % kColours.size()]);
}

std::vector<CurvePoint> errorOverLength(const std::vector<const Comparison*>& sequences) {
    std::map<double, std::vector<Segment>> byLength;
    for (const auto* sequence : sequences)
        for (const auto& segment : sequence->row.kitti.all)
            byLength[segment.length_m].push_back(segment);
    std::vector<CurvePoint> curve;
    for (const auto& [length, segments] : byLength) append(curve, length, segments);
    return curve;
}

std::vector<CurvePoint> errorOverSpeed(const std::vector<const Comparison*>& sequences) {
    std::map<int, std::vector<Segment>> bySpeed;  // of the points, counted from 1
    for (const auto* sequence : sequences)
        for (const auto& segment : sequence->row.kitti.all) {
            const double duration =
                sequence->times_s[segment.last] - sequence->times_s[segment.first];
            if (segment.length_m >= kTooFast_mps * duration) continue;
            const double place = segment.length_m / duration / kSpeedStep_mps;
            // The points less than one step away: one below, one above, or just its own.
            for (int k = std::max(1, static_cast<int>(std::floor(place))); k < place + 1; ++k)
                if (std::abs(k - place) < 1) bySpeed[k].push_back(segment);
        }
    std::vector<CurvePoint> curve;
    for (const auto& [k, segments] : bySpeed) append(curve, 3.6 * kSpeedStep_mps * k, segments);
    return curve;
}

std::vector<Chart> overviewCharts(const std::vector<Group>& byEstimate) {
    using Curve = std::vector<CurvePoint> (*)(const std::vector<const Comparison*>&);
    struct Over {
        const char *name, *of, *axis;
        Curve curve;
    };
    const Over overs[] = {{"length", "path length", "length of the segment [m]", errorOverLength},
                          {"speed", "speed", "mean speed on the segment [km/h]", errorOverSpeed}};
    std::vector<Chart> charts;
    for (const auto& over : overs) {
        Chart translation(std::string("all_translation_over_") + over.name,
                          std::string("Translation error over ") + over.of);
        Chart rotation(std::string("all_rotation_over_") + over.name,
                       std::string("Rotation error over ") + over.of);
        translation.label(over.axis, "translation error [%]");
        rotation.label(over.axis, "rotation error [deg/100 m]");
        for (auto* chart : {&translation, &rotation}) chart->set("set yrange [0:*]");
        for (const auto& group : byEstimate) {
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

std::vector<Chart> sequenceCharts(const Group& sequence, const std::string& prefix) {
    std::vector<StepErrors> translation, rotation;
    for (std::size_t i = 0; i < sequence.members.size(); ++i) {
        const auto* member = sequence.members[i];
        translation.push_back({member, sequence.estimates[i], member->perScan.translations_m});
        rotation.push_back({member, sequence.estimates[i], member->perScan.rotations_deg});
    }
    return {trajectoryChart(sequence, prefix), heightChart(sequence, prefix),
            overTimeChart(translation, prefix + "translation_over_time", "Translation", "m"),
            overTimeChart(rotation, prefix + "rotation_over_time", "Rotation", "deg")};
}
}  // namespace delio::evaluation
