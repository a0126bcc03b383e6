#include "several_drives.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <list>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/io/output_file.h"
#include "delio/io/scan_reader.h"
#include "delio/io/trajectory.h"
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
            throw Error("two drives are called '" + name +
                        "': their results would be one another's");
        drives.push_back({input, name});
    }
    return drives;
}

/** Maps of drives that meet. */
class Joiner {
 public:
    Joiner(const run::RunSettings& settings, const SlamDrive& slam)
        : settings_(settings), slam_(slam) {}

    int exitCode() const { return exitCode_; }

    /** Takes the drives out of `pending` that meet the first, or each other by way of it. */
    void joinFirst(std::list<Drive>& pending) {
        Drive first = pending.front();
        pending.pop_front();
        if (!first.ran) run(first, "");
        if (!first.ran) return;
        map_ = fileOf(maps_);
        fs::rename(folderOf(first).path(RunFolder::kStoredMap), map_);
        ++maps_;
        joinTo(pending);
    }

    /** The same with a map that is there already. */
    void joinMap(const std::string& map, std::list<Drive>& pending) {
        map_ = fileOf(maps_);
        fs::copy_file(run::storedMapIn(map), map_, fs::copy_options::overwrite_existing);
        ++maps_;
        joinTo(pending);
    }

    std::size_t maps() const { return maps_; }
    std::string fileOf(std::size_t map) const {
        const std::string name =
            map == 0 ? "map.delio" : "map-" + std::to_string(map + 1) + ".delio";
        return (fs::path(settings_.folder) / name).string();
    }

 private:
    RunFolder folderOf(const Drive& drive) const {
        return RunFolder((fs::path(settings_.folder) / drive.name).string());
    }

    /** `drive.ran`: it has a map now. */
    DriveResult run(Drive& drive, const std::string& map) {
        drive.ran = false;
        if (cli::interrupted()) return {};
        auto settings = settings_;
        settings.folder = (fs::path(settings_.folder) / drive.name).string();
        settings.storedMap = map;
        settings.extend = settings.mayBeElsewhere = !map.empty();
        std::cout << "drive                      " << drive.name << "\n";
        try {
            fs::create_directories(settings.folder);
            const auto result = slam_(drive.input, settings);
            if (result.exitCode != 0) exitCode_ = result.exitCode;
            drive.ran = folderOf(drive).has(RunFolder::kStoredMap);
            return result;
        } catch (const std::exception& e) {
            cli::inform("'" + drive.input + "' is left out: " + plainMessage(e));
            exitCode_ = cli::kExitFailedRun;
            return {};
        }
    }

    /** What was too far off may meet a map that has grown. */
    void joinTo(std::list<Drive>& pending) {
        for (auto drive = pending.begin(); drive != pending.end();) {
            const auto result = run(*drive, map_);
            if (drive->ran && !result.extended) {
                ++drive;
                continue;
            }
            if (result.extended) fs::rename(folderOf(*drive).path(RunFolder::kStoredMap), map_);
            const auto next = pending.erase(drive);
            drive = result.grown ? pending.begin() : next;
        }
    }

    const run::RunSettings& settings_;
    const SlamDrive& slam_;
    std::string map_;       //!< that drives are joined to
    std::size_t maps_ = 0;  //!< that were begun
    int exitCode_ = cli::kExitSuccess;
};

/** Trajectories of all drives in their maps, drives.csv, and the same in words. */
void report(const Joiner& joiner, const std::string& folder) {
    std::string table = "map,drive\n";
    for (std::size_t i = 0; i < joiner.maps(); ++i) {
        const StoredMap map(joiner.fileOf(i));
        const std::string name = fs::path(map.path()).filename().string();
        std::string drives;
        for (const auto& drive : map.drives()) {
            const std::string path = (fs::path(folder) / drive.name).string();
            const auto trajectory = map.trajectory(drive);
            io::writeKitti(trajectory, path + "_kitti.txt");
            const auto& stamps = trajectory.stamps_s;
            if (std::adjacent_find(stamps.begin(), stamps.end(), std::greater_equal<>()) ==
                stamps.end())  // a clock that was set back: no file could be read again
                io::writeTum(trajectory, path + "_tum.txt");
            table += name + "," + drive.name + "\n";
            drives += (drives.empty() ? "" : ", ") + drive.name;
        }
        std::cout << mrpt::format("%-26s %s\n", name.c_str(), drives.c_str());
    }
    io::replaceTextFile((fs::path(folder) / "drives.csv").string(),
                        [&](std::ostream& out) { out << table; });
    if (joiner.maps() > 1)
        cli::warn("the drives do not all meet: " + std::to_string(joiner.maps()) +
                  " separate maps, each with a frame of its own (drives.csv)");
}
}  // namespace

int slamSeveral(const std::vector<std::string>& inputs, const run::RunSettings& settings,
                const SlamDrive& slam) {
    auto pending = drivesOf(inputs);
    Joiner joiner(settings, slam);
    if (!settings.storedMap.empty()) joiner.joinMap(settings.storedMap, pending);
    while (!pending.empty() && !cli::interrupted()) joiner.joinFirst(pending);
    report(joiner, settings.folder);
    return cli::interrupted() ? cli::kExitInterrupted : joiner.exitCode();
}
}  // namespace delio
