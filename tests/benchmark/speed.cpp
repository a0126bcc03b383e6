// Where the time of delio-slam goes: benchmark_speed [--runs N] [--threads N] [--profile NAME]
// [--set KEY=VALUE] [--map] [--beside COMMAND] RECORDING... For each recording, by stage and for a
// whole scan (from when it is wanted to its pose), the median, the 95 % and the worst; wall time
// and CPU time of the whole program a scan, and its memory. Of each scan the median of the runs
// counts: other programs' noise is not ours. COMMAND, in which {} is the recording, runs in turn
// with delio-slam.
#include <fcntl.h>
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"
#include "test_data.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

/** What a program took. */
struct Taken {
    double wall_ms = 0, cpu_ms = 0, memory_mb = 0;
};

double milliseconds(const timeval& time) {
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_usec);
}

Taken run(const std::vector<std::string>& command) {
    Stopwatch watch;
    const pid_t child = fork();
    if (child == 0) {
        const int nowhere = open("/dev/null", O_RDWR);
        for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
        std::vector<char*> words;
        for (const auto& word : command) words.push_back(const_cast<char*>(word.c_str()));
        words.push_back(nullptr);
        execvp(words[0], words.data());
        _exit(127);
    }
    int status = 0;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    if (status != 0) throw Error("'" + command.front() + "' failed");
    return {watch.lap_ms(), milliseconds(usage.ru_utime) + milliseconds(usage.ru_stime),
            static_cast<double>(usage.ru_maxrss) / 1024};
}

std::vector<std::string> cellsOf(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    return cells;
}

/** Milliseconds of every scan, by stage in their order; "scan" is their sum. */
using Stages = std::vector<std::pair<std::string, std::vector<double>>>;

Stages stagesIn(const fs::path& table) {
    std::ifstream in(table);
    std::string line;
    std::getline(in, line);
    const auto heading = cellsOf(line);
    const std::string end = "_ms";
    Stages stages;
    std::vector<std::size_t> columns;
    for (std::size_t i = 0; i < heading.size(); ++i) {
        const auto at = heading[i].rfind(end);
        if (at == std::string::npos || at + end.size() != heading[i].size()) continue;
        stages.push_back({heading[i].substr(0, at), {}});
        columns.push_back(i);
    }
    std::vector<double> sums;
    while (std::getline(in, line)) {
        const auto cells = cellsOf(line);
        sums.push_back(0);
        for (std::size_t k = 0; k < columns.size(); ++k) {
            stages[k].second.push_back(std::stod(cells.at(columns[k])));
            sums.back() += stages[k].second.back();
        }
    }
    stages.emplace_back("scan", sums);
    return stages;
}

/** Of values in any order the one behind that share of them. */
double quantile(std::vector<double> values, double share) {
    if (values.empty()) throw Error("nothing was measured");
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}
double median(const std::vector<double>& values) { return quantile(values, 0.5); }

/** Of each scan the median of all runs. */
std::vector<double> typical(const std::vector<Stages>& runs, std::size_t stage) {
    std::vector<double> scans(runs.front()[stage].second.size());
    for (std::size_t i = 0; i < scans.size(); ++i) {
        std::vector<double> ms;
        for (const auto& run : runs) ms.push_back(run[stage].second.at(i));
        scans[i] = median(ms);
    }
    return scans;
}

double medianOf(const std::vector<Taken>& runs, double Taken::*figure) {
    std::vector<double> values;
    for (const auto& run : runs) values.push_back(run.*figure);
    return median(values);
}

void print(const char* name, const std::vector<Taken>& runs, std::size_t scans) {
    const auto count = static_cast<double>(scans);
    std::printf("  %-14s %7.2f ms a scan of the whole program, %7.2f of CPU, %5.0f MB\n", name,
                medianOf(runs, &Taken::wall_ms) / count, medianOf(runs, &Taken::cpu_ms) / count,
                medianOf(runs, &Taken::memory_mb));
}

struct Plan {
    std::vector<std::string> slam;  //!< without recording and folder
    std::string beside;
    unsigned runs = 5;
};

void measure(const std::string& recording, const Plan& plan) {
    const test::TemporaryFolder folder;
    auto slam = plan.slam;
    const std::string results = fs::path(folder / "run").string();
    slam.insert(slam.end(), {"-i", recording, "-o", results});
    std::string beside = plan.beside;
    if (const auto at = beside.find("{}"); at != beside.npos) beside.replace(at, 2, recording);
    std::vector<Stages> stages;
    std::vector<Taken> own, other;
    for (unsigned i = 0; i < plan.runs; ++i) {
        own.push_back(run(slam));
        stages.push_back(stagesIn(fs::path(results) / "scans.csv"));
        if (!beside.empty()) other.push_back(run({"sh", "-c", beside}));
    }
    const std::size_t scans = stages.front().back().second.size();
    std::printf("%s: %zu scans, %u runs\n  %-14s %9s %9s %9s\n", recording.c_str(), scans,
                plan.runs, "ms", "median", "95 %", "worst");
    for (std::size_t k = 0; k < stages.front().size(); ++k) {
        const auto ms = typical(stages, k);
        std::printf("  %-14s %9.2f %9.2f %9.2f\n", stages.front()[k].first.c_str(), median(ms),
                    quantile(ms, 0.95), quantile(ms, 1));
    }
    print("delio-slam", own, scans);
    if (!other.empty()) print("beside it", other, scans);
    std::fflush(stdout);
}
}  // namespace

int main(int argc, char** argv) {
    try {
        TCLAP::CmdLine cmd("Where the time of delio-slam goes");
        TCLAP::ValueArg<unsigned> runs("", "runs", "Of each recording", false, 5, "N", cmd);
        TCLAP::ValueArg<std::string> threads("", "threads", "", false, "2", "N", cmd);
        TCLAP::ValueArg<std::string> profile("", "profile", "", false, "accurate", "NAME", cmd);
        TCLAP::MultiArg<std::string> set("", "set", "As of delio-slam", false, "key=value", cmd);
        TCLAP::SwitchArg map("", "map", "With map, scene and pictures", cmd);
        TCLAP::ValueArg<std::string> beside(
            "", "beside", "Another program's command; {}: recording", false, "", "COMMAND", cmd);
        TCLAP::UnlabeledMultiArg<std::string> recordings("recordings", "What it runs on", true,
                                                         "RECORDING", cmd);
        cmd.parse(argc, argv);
        Plan plan;
        plan.runs = std::max(1U, runs.getValue());
        plan.beside = beside.getValue();
        plan.slam = {fs::read_symlink("/proc/self/exe").parent_path() / "delio-slam",
                     "--force",
                     "--threads",
                     threads.getValue(),
                     "--profile",
                     profile.getValue()};
        if (!map.getValue()) plan.slam.push_back("--no-map");
        for (const auto& option : set.getValue())
            plan.slam.insert(plan.slam.end(), {"--set", option});
        for (const auto& recording : recordings.getValue()) measure(recording, plan);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "benchmark_speed: %s\n", plainMessage(e).c_str());
        return 1;
    }
}
