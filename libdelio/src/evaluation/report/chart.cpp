#include "delio/evaluation/report/chart.h"

#include <fcntl.h>
#include <mrpt/core/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/core/printable.h"
#include "delio/files/output_file.h"

namespace delio::evaluation {
namespace fs = std::filesystem;

namespace {
constexpr std::size_t kLongestTitle = 32;  // characters; longer ones push the key off the plot

/** As a string of gnuplot. What has a meaning to it somewhere in a string (quotes, which no
 * doubling makes safe at the beginning, backquotes, backslashes ...) is written as its code. */
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

/** What gnuplot says about its failure: the line with the reason is the last that is not empty. */
std::string lastLine(const std::string& file) {
    std::ifstream in(file);
    std::string last;
    for (std::string line; std::getline(in, line);)
        if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
    return last.substr(std::min(last.find_first_not_of(" \t"), last.size()));
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
        throw Error(
            "gnuplot, which draws the report's plots, is not installed; install the "
            "package gnuplot-nox (apt-get install gnuplot-nox)");
    bool all = exitCode == 0;
    for (const auto& chart : charts)
        for (const char* extension : {".svg", ".png"}) {
            std::error_code fault;
            const auto size = fs::file_size(fs::path(folder) / (chart.name() + extension), fault);
            all = all && !fault && size > 0;
        }
    if (!all)
        throw Error("gnuplot could not draw the plots" +
                    (reason.empty() ? ": is the disk full?" : ": " + reason));
}
}  // namespace delio::evaluation
