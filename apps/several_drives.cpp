#include "several_drives.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <list>
#include <set>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/run_folder.h"

namespace delio {
namespace fs = std::filesystem;
using run::RunFolder;

namespace {
struct Drive {
    std::string input, name;
    bool ran = false;  //!< its folder has a map of its own
};

std::list<Drive> drivesOf(const std::vector<std::string>& inputs) {
    std::list<Drive> drives;
    for (const auto& input : inputs) {
        const std::string name = io::nameOfDrive(input);
        if (std::any_of(drives.begin(), drives.end(),
                        [&](const Drive& other) { return other.name == name; }))
            throw Error("two drives have the same name, '" + name +
                        "': they would overwrite each other's results");
        drives.push_back({input, name});
    }
    return drives;
}

std::string kittiOf(const std::string& drive) { return drive + "_kitti.txt"; }
std::string tumOf(const std::string& drive) { return drive + "_tum.txt"; }
std::string mapName(std::size_t map) {
    return map == 0 ? RunFolder::kStoredMap : "map-" + std::to_string(map + 1) + ".delio";
}

/** Names in the folder of the results, of all that may be there after `drives` were joined, to
 *  those of the stored map `map`: drives.csv, which marks the whole, first. A name that two of them
 *  would have is an Error. */
std::vector<std::string> namesOf(const std::list<Drive>& drives, const std::string& map) {
    std::vector<std::string> names = {RunFolder::kDrives};
    // A run of one drive may have been here.
    for (const auto& file : RunFolder("").files())
        if (file != RunFolder::kDrives) names.push_back(file);
    for (std::size_t i = 1; i <= drives.size(); ++i) names.push_back(mapName(i));
    std::vector<std::string> all;
    if (!map.empty()) {
        const StoredMap stored(map);
        for (const auto& drive : stored.drives()) all.push_back(drive.name);
    }
    for (const auto& drive : drives) all.push_back(drive.name);
    for (const auto& drive : all) names.insert(names.end(), {kittiOf(drive), tumOf(drive)});
    std::set<std::string> taken(names.begin(), names.end());
    if (taken.size() < names.size())
        throw Error("a recording and a drive of the map '" + map +
                    "' have the same name: they would overwrite each other's trajectories");
    taken.insert(RunFolder::kIncomplete);
    for (const auto& drive : drives) {
        if (taken.count(drive.name) > 0)
            throw Error("a drive cannot have the name '" + drive.name + "' (from '" + drive.input +
                        "'): a result file has this name; rename the recording");
        for (const auto& file : RunFolder(drive.name).files()) names.push_back(file);
    }
    return names;
}

/** Maps of drives that meet. All is written into `partial`. */
class Joiner {
 public:
    Joiner(const io::PartialFolder& partial, const run::RunSettings& settings,
           const SlamDrive& slam)
        : partial_(partial), settings_(settings), slam_(slam) {}

    int exitCode() const { return exitCode_; }

    /** Takes the drives out of `pending` that meet the first, or each other by way of it. */
    void joinFirst(std::list<Drive>& pending) {
        Drive first = pending.front();
        pending.pop_front();
        if (!first.ran) run(first, "");
        if (!first.ran) return;
        map_ = maps_;
        fs::rename(folderOf(first).path(RunFolder::kStoredMap), fileOf(map_));
        ++maps_;
        joinTo(pending);
    }

    /** The same with a map that is there already. */
    void joinMap(const std::string& map, std::list<Drive>& pending) {
        map_ = maps_;
        io::replaceFile(fileOf(map_), [&](const std::string& copy) {
            std::error_code fault;
            fs::copy_file(run::storedMapIn(map), copy, fault);
            return !fault;
        });
        ++maps_;
        joinTo(pending);
    }

    std::size_t maps() const { return maps_; }
    std::string fileOf(std::size_t map) const { return partial_.path() / mapName(map); }
    RunFolder folderOf(const Drive& drive) const {
        return RunFolder((partial_.path() / drive.name).string());
    }

 private:
    /** `drive.ran`: it has a map now. */
    DriveResult run(Drive& drive, const std::string& map) {
        drive.ran = false;
        if (cli::interrupted()) return {};
        auto settings = settings_;
        settings.folder = (partial_.path() / drive.name).string();
        settings.storedMap = map;
        settings.storedMapName = partial_.asInPlace(map);
        settings.extend = settings.mayBeElsewhere = !map.empty();
        std::cout << "drive                      " << drive.name << "\n";
        try {
            fs::create_directories(settings.folder);
            const auto result = slam_(drive.input, settings, partial_.asInPlace(settings.folder));
            if (result.exitCode != 0) exitCode_ = result.exitCode;
            drive.ran = folderOf(drive).has(RunFolder::kStoredMap);
            return result;
        } catch (const std::exception& e) {
            cli::inform("'" + drive.input +
                        "' is left out: " + partial_.asInPlace(plainMessage(e)));
            exitCode_ = cli::kExitFailedRun;
            return {};
        }
    }

    /** Drives without overlap are retried once the map has grown. */
    void joinTo(std::list<Drive>& pending) {
        for (auto drive = pending.begin(); drive != pending.end();) {
            const auto result = run(*drive, fileOf(map_));
            if (drive->ran && !result.extended) {
                ++drive;
                continue;
            }
            if (result.extended)
                fs::rename(folderOf(*drive).path(RunFolder::kStoredMap), fileOf(map_));
            const auto next = pending.erase(drive);
            drive = result.grown ? pending.begin() : next;
        }
    }

    const io::PartialFolder& partial_;
    const run::RunSettings& settings_;
    const SlamDrive& slam_;
    std::size_t map_ = 0;   //!< that drives are joined to
    std::size_t maps_ = 0;  //!< that were begun
    int exitCode_ = cli::kExitSuccess;
};

/** Trajectories of all drives in their maps, drives.csv, and the same in words. */
void report(const Joiner& joiner, const fs::path& folder) {
    std::string table = "map,drive\n";
    for (std::size_t i = 0; i < joiner.maps(); ++i) {
        const StoredMap map(joiner.fileOf(i));
        const std::string name = fs::path(map.path()).filename().string();
        std::string drives;
        for (const auto& drive : map.drives()) {
            const auto trajectory = map.trajectory(drive);
            io::writeKitti(trajectory, folder / kittiOf(drive.name));
            const auto& stamps = trajectory.stamps_s;
            if (std::adjacent_find(stamps.begin(), stamps.end(), std::greater_equal<>()) ==
                stamps.end())  // a clock that was set back: no file could be read again
                io::writeTum(trajectory, folder / tumOf(drive.name));
            table += name + "," + drive.name + "\n";
            drives += (drives.empty() ? "" : ", ") + drive.name;
        }
        std::cout << mrpt::format("%-26s %s\n", name.c_str(), drives.c_str());
    }
    io::replaceTextFile(folder / RunFolder::kDrives, [&](std::ostream& out) { out << table; });
    if (joiner.maps() > 1)
        cli::warn("not all drives overlap: " + std::to_string(joiner.maps()) +
                  " separate maps, each in its own frame (see drives.csv)");
}
}  // namespace

int slamSeveral(const std::vector<std::string>& inputs, const run::RunSettings& settings,
                const SlamDrive& slam) {
    const auto drives = drivesOf(inputs);
    const auto& map = settings.storedMap;
    const auto names = namesOf(drives, map.empty() ? "" : run::storedMapIn(map));
    io::PartialFolder partial(settings.folder, settings.folder);
    try {
        auto pending = drives;
        Joiner joiner(partial, settings, slam);
        if (!map.empty()) joiner.joinMap(map, pending);
        while (!pending.empty() && !cli::interrupted()) joiner.joinFirst(pending);
        const bool anyRan = std::any_of(drives.begin(), drives.end(), [&](const Drive& drive) {
            return joiner.folderOf(drive).has(RunFolder::kSummary);
        });
        if (anyRan) {
            report(joiner, partial.path());
            partial.putInPlace(names);
        }
        return cli::interrupted() ? cli::kExitInterrupted : joiner.exitCode();
    } catch (const std::exception& e) {
        throw Error(partial.asInPlace(plainMessage(e)));
    }
}

std::vector<std::string> filesOfSeveral(const std::vector<std::string>& inputs,
                                        const std::string& map, const std::string& folder) {
    auto files = namesOf(drivesOf(inputs), map);
    for (auto& file : files) file = (fs::path(folder) / file).string();
    return files;
}
}  // namespace delio
