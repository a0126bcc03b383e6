// DeLiO in many places (share/doc/method/accuracy.md): four sensors, four scenes, from rest and
// moving, upright and turned, beside another program if its poses are there. A row a drive:
//   benchmark_anywhere --work DIR [--seeds 101,102,103] [--only sensor=vlp16,scene=loop|rural]
//       [--peer FOLDER] [--profile NAME] [--scans N] [--drives-only]
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <sstream>

#include "anywhere.h"
#include "delio/core/error.h"
#include "delio/core/text.h"

namespace {
using namespace delio;
using test::Cell;
namespace fs = std::filesystem;

struct Settings {
    fs::path work, peer;
    std::string profile;
    int scans = 0;
    bool drivesOnly = false;
};

struct Row {
    test::CellRun run;
    double peer_percent = NAN;
};

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::istringstream in(text);
    for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
    return parts;
}

std::vector<int> seedsIn(const std::string& text) {
    std::vector<int> seeds;
    for (const auto& word : split(text, ',')) {
        const auto seed = numberIn<int>(word);
        if (!seed) throw Error("--seeds: '" + word + "' is no number");
        seeds.push_back(*seed);
    }
    return seeds;
}

/** The cells that have one of the wanted values for each key of `only`. */
std::vector<Cell> chosen(std::vector<Cell> cells, const std::string& only) {
    static const std::map<std::string, std::string Cell::*> kKeys = {{"sensor", &Cell::sensor},
                                                                     {"scene", &Cell::scene},
                                                                     {"start", &Cell::start},
                                                                     {"mount", &Cell::mount}};
    for (const auto& part : split(only, ',')) {
        const auto equals = std::min(part.find('='), part.size());
        const auto key = kKeys.find(part.substr(0, equals));
        if (key == kKeys.end()) throw Error("--only: there is no '" + part.substr(0, equals) + "'");
        const auto wanted = split(part.substr(std::min(equals + 1, part.size())), '|');
        const auto isOther = [&](const Cell& cell) {
            return std::find(wanted.begin(), wanted.end(), cell.*key->second) == wanted.end();
        };
        cells.erase(std::remove_if(cells.begin(), cells.end(), isOther), cells.end());
    }
    if (cells.empty()) throw Error("--only '" + only + "' leaves no cell");
    return cells;
}

/** Makes the drive unless it is there. For other programs its scans are in velodyne/, as
 *  KITTI has them. */
test::CellDrive driveOf(const Cell& cell, const Settings& settings) {
    const fs::path folder = settings.work / cell.name(), scans = folder / "velodyne";
    char last[32];
    std::snprintf(last, sizeof(last), "%06d.bin", settings.scans - 1);
    if (fs::exists(scans / last)) return {(folder / "d.rawlog").string()};
    fs::remove_all(folder);
    fs::create_directories(scans);
    auto drive = test::makeDrive(cell, settings.scans, folder);
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / "d_Images"))
        if (entry.path().extension() == ".bin") files.push_back(entry.path());
    std::sort(files.begin(), files.end());  // the last one says that all are there
    for (const auto& file : files) fs::create_hard_link(file, scans / file.filename());
    return drive;
}

Row measure(const Cell& cell, const Settings& settings) {
    const auto drive = driveOf(cell, settings);
    Row row;
    std::printf("%-7s %-8s %-7s %-8s %5d %8.1f", cell.sensor.c_str(), cell.scene.c_str(),
                cell.start.c_str(), cell.mount.c_str(), cell.seed, drive.path_m());
    const fs::path peer = settings.peer / (cell.name() + ".txt");
    if (!settings.peer.empty() && fs::exists(peer))
        row.peer_percent = drive.endError_percent(io::readTrajectory(peer.string()));
    if (!settings.drivesOnly) {
        row.run =
            test::runOn(drive, settings.work / cell.name() / settings.profile, settings.profile);
        std::printf(" %9.3f", row.run.endError_percent);
        if (!settings.peer.empty()) std::printf(" %9.3f", row.peer_percent);
        std::printf(" %9zu %5zu %-6s %6.0f", row.run.predicted, row.run.weak,
                    row.run.warned ? "yes" : "no", row.run.ms_per_scan);
    }
    std::printf("\n");
    std::fflush(stdout);
    return row;
}

/** Gives how many cells were lost without a word. */
std::size_t summarise(const std::vector<Row>& rows, bool hasPeer) {
    std::size_t good = 0, better = 0, both = 0, silent = 0;
    for (const auto& row : rows) {
        const bool isGood = row.run.endError_percent < 1;
        const bool isBetter = row.run.endError_percent < row.peer_percent;
        good += isGood;
        better += isBetter;
        both += isGood && isBetter;
        silent += row.run.lostInSilence();
    }
    const auto say = [&](const char* what, std::size_t count) {
        std::printf("%-28s %4zu (%5.1f %%)\n", what, count,
                    100 * static_cast<double>(count) / static_cast<double>(rows.size()));
    };
    std::printf("\n");
    say("cells", rows.size());
    say("below 1 %", good);
    if (hasPeer) {
        say("below the peer", better);
        say("both", both);
    }
    say("above 5 % without a warning", silent);
    return silent;
}
}  // namespace

int main(int argc, char** argv) try {
    TCLAP::CmdLine cmd("benchmark_anywhere: DeLiO in many places, with many sensors");
    TCLAP::ValueArg<std::string> work(
        "", "work", "Drives and results; kept and used again; 60 MB a drive on average", true, "",
        "DIR", cmd);
    TCLAP::ValueArg<std::string> seeds("", "seeds", "Each seed: 96 drives", false, "101,102,103",
                                       "N,N,...", cmd);
    TCLAP::ValueArg<std::string> only("", "only", "Some of them: KEY=VALUE|VALUE,KEY=VALUE,...",
                                      false, "", "CELLS", cmd);
    TCLAP::ValueArg<std::string> profile("", "profile", "DeLiO's profile", false, "accurate",
                                         "NAME", cmd);
    TCLAP::ValueArg<std::string> peer(
        "", "peer",
        "Another program's poses of the LiDAR, from DIR/CELL/velodyne/*.bin: FOLDER/CELL.txt, "
        "12 numbers a line",
        false, "", "FOLDER", cmd);
    TCLAP::ValueArg<int> scans("", "scans", "Scans of a drive", false, 60, "N", cmd);
    TCLAP::SwitchArg drivesOnly("", "drives-only", "Make the drives, for the other program", cmd);
    cmd.parse(argc, argv);
    const Settings settings{work.getValue(), peer.getValue(), profile.getValue(), scans.getValue(),
                            drivesOnly.getValue()};
    const auto cells = chosen(test::cellsOf(seedsIn(seeds.getValue())), only.getValue());
    std::printf("%-7s %-8s %-7s %-8s %5s %8s %9s%s %9s %5s %-6s %6s\n", "sensor", "scene", "start",
                "mount", "seed", "path m", "DeLiO %", settings.peer.empty() ? "" : "    peer %",
                "predicted", "weak", "warned", "ms");
    std::vector<Row> rows;
    rows.reserve(cells.size());
    for (const auto& cell : cells) rows.push_back(measure(cell, settings));
    return !settings.drivesOnly && summarise(rows, !settings.peer.empty()) > 0 ? 1 : 0;
} catch (const std::exception& e) {
    std::cerr << plainMessage(e) << "\n";
    return 1;
}
