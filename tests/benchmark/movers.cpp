// What moves, against the labels of synth2rawlog --labels: benchmark_movers [--set
// section.key=value] DRIVE.rawlog... Points within 60 m, after the first second (nothing can be
// told from less).
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string_view>

#include "delio/core/error.h"
#include "delio/formats/drive_meta.h"
#include "delio/odometry/odometry.h"
#include "delio/recordings/rawlog_reader.h"
#include "delio/slam/options.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

struct Counts {
    std::size_t found = 0, missed = 0, wrong = 0;

    void add(bool moves, bool told) {
        found += moves && told;
        missed += moves && !told;
        wrong += !moves && told;
    }
    static double share(std::size_t part, std::size_t rest) {
        return 100.0 * static_cast<double>(part) /
               static_cast<double>(std::max<std::size_t>(part + rest, 1));
    }
    double precision() const { return share(found, wrong); }
    double recall() const { return share(found, missed); }
};

std::vector<char> labelsOf(const std::string& rawlog, std::size_t scan) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06zu.label", scan);
    std::ifstream in(fs::path(io::sidecarPath(rawlog, "_Images")) / name, std::ios::binary);
    if (!in) throw Error("'" + rawlog + "' has no labels: make it with synth2rawlog --labels");
    return {std::istreambuf_iterator<char>(in), {}};
}

void measure(const std::string& rawlog, const Options& options) {
    constexpr std::array<float, 4> kEdges_m = {0, 20, 40, 60};
    constexpr double kStart_s = 1;
    std::array<Counts, kEdges_m.size()> counts;  // the last: all
    double ms = 0;
    std::size_t scans = 0;
    io::RawlogReader reader(rawlog);
    const auto odometry = makeOdometry(options);
    while (const auto scan = reader.next()) {
        const Step step = odometry->process(*scan);
        for (const auto& [stage, time_ms] : step.times_ms)
            if (std::string_view(stage) == "dynamic") ms += time_ms;
        ++scans;
        if (scan->stamp_s < kStart_s || step.used.dynamic.empty()) continue;
        const auto labels = labelsOf(rawlog, scan->index);
        for (std::size_t i = 0; i < step.used.indices.size(); ++i) {
            const float range = step.used.points.col(static_cast<Eigen::Index>(i)).norm();
            const bool moves = labels.at(step.used.indices[i]) != 0;
            for (std::size_t k = 0; k + 1 < kEdges_m.size(); ++k)
                if (range >= kEdges_m[k] && range < kEdges_m[k + 1])
                    counts[k].add(moves, step.used.dynamic[i] != 0);
            if (range < kEdges_m.back()) counts.back().add(moves, step.used.dynamic[i] != 0);
        }
    }
    std::printf("%-28s", fs::path(rawlog).filename().string().c_str());
    for (const auto& c : counts) std::printf("  %5.1f / %5.1f", c.precision(), c.recall());
    std::printf("  %6.1f\n", ms / static_cast<double>(scans));
}
}  // namespace

int main(int argc, char** argv) try {
    TCLAP::CmdLine cmd("benchmark_movers: dynamic objects against labels");
    TCLAP::MultiArg<std::string> set("", "set", "One option; may be repeated", false,
                                     "section.key=value", cmd);
    TCLAP::UnlabeledMultiArg<std::string> rawlogs("rawlogs", "Drives with labels", true,
                                                  "DRIVE.rawlog", cmd);
    cmd.parse(argc, argv);
    std::printf("precision / recall in %% of the points\n%-28s  %-13s  %-13s  %-13s  %-13s  %s\n",
                "", "0-20 m", "20-40 m", "40-60 m", "0-60 m", "ms/scan");
    for (const auto& rawlog : rawlogs.getValue()) {
        Options options = Options::forDrive("accurate", io::readDriveMeta(rawlog));
        for (const auto& assignment : set.getValue()) options.set(assignment);
        options.check();
        measure(rawlog, options);
    }
    return 0;
} catch (const std::exception& e) {
    std::cerr << plainMessage(e) << "\n";
    return 1;
}
