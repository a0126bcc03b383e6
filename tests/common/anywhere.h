#pragma once
#include <Eigen/Geometry>

#include <filesystem>
#include <string>
#include <vector>

#include "delio/formats/trajectory.h"

namespace delio::test {
/** A drive of share/doc/method/accuracy.md's table "Anywhere". */
struct Cell {
    std::string sensor, scene;
    std::string start;  //!< synth2rawlog's --start; empty: as the seed has it
    std::string mount;  //!< upright, pitched (25 deg down ahead) or rolled (by 90 deg)
    int seed = 0;
    std::string motion = {};  //!< synth2rawlog's --motion; empty: a vehicle's

    std::string name() const;
};

/** Every cell of the table: 96 a seed. */
std::vector<Cell> cellsOf(const std::vector<int>& seeds);

/** A cell's scans and their truth. */
struct CellDrive {
    std::string rawlog;

    /** Where a trajectory of the LiDAR ends beside the truth, both seen from their first pose, in %
     *  of the path; infinite where it has not a pose for every scan. */
    double endError_percent(const io::Trajectory& lidar) const;
    double path_m() const;
};

/** Makes `folder`/d.rawlog and what belongs to it, with 8 movers. Throws Error where it cannot. */
CellDrive makeDrive(const Cell& cell, int scans, const std::filesystem::path& folder);

/** What delio-slam found on a cell's drive. */
struct CellRun {
    double endError_percent = 0;
    bool warned = false;  //!< that many scans were not registered, or weakly; or it failed
    std::size_t predicted = 0, weak = 0;
    double ms_per_scan = 0;

    /** Far from the truth, and the user was told nothing. */
    bool lostInSilence() const { return !(endError_percent <= 5) && !warned; }
};

/** Runs delio-slam, whose results go to `out`. Throws Error where there are none. */
CellRun runOn(const CellDrive& drive, const std::filesystem::path& out,
              const std::string& profile = "accurate");
}  // namespace delio::test
