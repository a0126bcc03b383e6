#include "anywhere.h"

#include <cmath>
#include <limits>

#include "command.h"
#include "delio/core/error.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/drive_meta.h"
#include "delio/run/doubts.h"
#include "delio/run/run_folder.h"

namespace delio::test {
namespace {
std::string anglesOf(const std::string& mount) {
    if (mount == "pitched") return "0,25,0";
    return mount == "rolled" ? "90,0,0" : "0,0,0";
}

/** The true poses of the LiDAR. */
std::vector<Eigen::Isometry3d> truthOf(const std::string& rawlog) {
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    auto poses = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt"));
    return io::lidarToCam0(poses, Tr.inverse()).poses;
}

bool warnedOf(const run::Summary& summary) {
    run::Doubts doubts;
    doubts.pairs = summary.scans - 1;
    doubts.predicted.scans = summary.predicted;
    doubts.weak.scans = summary.weakly_observed;
    return !run::warningsOf(doubts).empty();
}
}  // namespace

std::string Cell::name() const {
    std::string text = sensor + "_" + scene;
    for (const auto& word : {start, mount, motion})
        if (!word.empty()) text += "_" + word;
    return text + "_" + std::to_string(seed);
}

std::vector<Cell> cellsOf(const std::vector<int>& seeds) {
    std::vector<Cell> cells;
    for (const std::string sensor : {"vlp16", "hdl32e", "os1-64", "hdl64e"})
        for (const std::string scene : {"urban", "rural", "highway", "loop"})
            for (const std::string start : {"rest", "moving"})
                for (const std::string mount : {"upright", "pitched", "rolled"})
                    for (const int seed : seeds)
                        cells.push_back({sensor, scene, start, mount, seed, {}});
    return cells;
}

double CellDrive::path_m() const { return evaluation::pathLength_m(truthOf(rawlog)); }

double CellDrive::endError_percent(const io::Trajectory& lidar) const {
    const auto truth = truthOf(rawlog);
    if (lidar.poses.size() != truth.size()) return std::numeric_limits<double>::infinity();
    const auto endOf = [](const std::vector<Eigen::Isometry3d>& poses) -> Eigen::Vector3d {
        return (poses.front().inverse() * poses.back()).translation();
    };
    return 100 * (endOf(truth) - endOf(lidar.poses)).norm() / evaluation::pathLength_m(truth);
}

CellDrive makeDrive(const Cell& cell, int scans, const std::filesystem::path& folder) {
    const CellDrive drive{(folder / "d.rawlog").string()};
    std::vector<std::string> words = {
        "-o",       drive.rawlog,          "--scene",   cell.scene,
        "--sensor", cell.sensor,           "--seed",    std::to_string(cell.seed),
        "--scans",  std::to_string(scans), "--movers",  "8",
        "--mount",  anglesOf(cell.mount),  "--threads", "1",
        "--force"};
    if (!cell.start.empty()) words.insert(words.end(), {"--start", cell.start});
    if (!cell.motion.empty()) words.insert(words.end(), {"--motion", cell.motion});
    const auto made = runTool("synth2rawlog", words);
    if (made.exitCode != 0) throw Error(cell.name() + ": synth2rawlog: " + made.err);
    return drive;
}

CellRun runOn(const CellDrive& drive, const std::filesystem::path& out,
              const std::string& profile) {
    const auto slam = runTool("delio-slam", {"-i", drive.rawlog, "-o", out.string(), "--no-map",
                                             "--threads", "1", "--profile", profile, "--force"});
    const run::RunFolder folder(out.string());
    if (!folder.has(run::RunFolder::kSummary))
        throw Error("'" + drive.rawlog + "': delio-slam: " + slam.err);
    const auto summary = folder.summary();
    CellRun run;
    run.endError_percent = drive.endError_percent(folder.trajectory());
    run.warned = slam.exitCode != 0 || warnedOf(summary);
    run.predicted = summary.predicted;
    run.weak = summary.weakly_observed;
    run.ms_per_scan = summary.ms_per_scan;
    return run;
}
}  // namespace delio::test
