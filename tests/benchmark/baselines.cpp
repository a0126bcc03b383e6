// Odometries on the same scans in one run: DRIVE.rawlog with DRIVE.poses.txt, DRIVE.calib.txt (and
// DRIVE.meta.yaml) beside it. Writes OUTDIR/DRIVE/METHOD.txt (cam0) and prints one table.
//   benchmark_baselines -o OUTDIR [--method NAME]... [--count N] [--est NAME=DIR]...
//   DRIVE.rawlog...
// --est: poses of another program, DIR/DRIVE.txt, in the LiDAR frame.
#include <mrpt/core/Clock.h>
#include <mrpt/core/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>

#include "baseline.h"
#include "delio/core/error.h"
#include "delio/evaluation/report.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"

namespace {
using namespace delio;
using namespace delio::benchmark;
namespace fs = std::filesystem;

struct Method {
    std::string name;
    std::function<std::unique_ptr<Baseline>(const DriveFacts&)> make;
};

std::vector<Method> methods() {
    std::vector<Method> all = {{"coupled-lines", makeCoupledLines}, {"mrpt-icp", makeMrptIcp}};
#ifdef DELIO_HAVE_PCL
    all.push_back({"pcl-icp", makePclIcp});
    all.push_back({"pcl-plane-icp", makePclPlaneIcp});
    all.push_back({"pcl-gicp", makePclGicp});
    all.push_back({"pcl-ndt", makePclNdt});
#endif
    for (const char* profile : {"paper-literal", "paper", "accurate"})
        all.push_back({std::string("delio-") + profile,
                       [profile](const DriveFacts& facts) { return makeDelio(profile, facts); }});
    return all;
}

struct Drive {
    std::string rawlog, name;
    Eigen::Isometry3d Tr = Eigen::Isometry3d::Identity();
    std::vector<Eigen::Isometry3d> truth;  // of cam0
};

struct Settings {
    std::string out;
    std::size_t count = 0;  // scans; 0: all
    std::vector<std::string> wanted;
    std::vector<std::pair<std::string, std::string>> others;  // name, folder
};

Drive openDrive(const std::string& rawlog) {
    Drive drive;
    drive.rawlog = rawlog;
    drive.name = fs::path(rawlog).stem().string();
    const auto calibration = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt"));
    if (!calibration.hasTr) throw Error("'" + rawlog + "': its calib.txt has no Tr");
    drive.Tr = calibration.Tr;
    drive.truth = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    return drive;
}

/** Runs a method over a drive; writes its poses and prints its time per scan into `msFile`. */
void runMethod(const Method& method, const Drive& drive, std::size_t count,
               const std::string& poseFile, const std::string& msFile) {
    DriveFacts facts;
    if (const auto meta = io::readDriveMeta(drive.rawlog))
        facts.verticalCorrection_deg = meta->verticalCorrectionDeg;
    const auto reader = io::openScans(drive.rawlog);
    const std::unique_ptr<Baseline> baseline = method.make(facts);
    double seconds = 0;
    std::size_t scans = 0;
    for (; count == 0 || scans < count; ++scans) {
        const auto scan = reader->next();
        if (!scan) break;
        const double begin = mrpt::Clock::nowDouble();
        baseline->process(*scan);
        seconds += mrpt::Clock::nowDouble() - begin;
    }
    if (scans == 0) throw Error("'" + drive.rawlog + "' has no scan");
    io::writeKitti(io::lidarToCam0({baseline->poses(), {}}, drive.Tr), poseFile);
    std::ofstream(msFile) << 1e3 * seconds / static_cast<double>(scans);
}

/** The same in a process of its own, whose peak memory is the method's; megabytes. */
double peakMemoryOf(const std::function<void()>& work) {
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        try {
            work();
            _exit(0);
        } catch (const std::exception& e) {
            std::fprintf(stderr, "benchmark_baselines: %s\n", e.what());
            _exit(1);
        }
    }
    int status = 0;
    rusage usage{};
    if (child < 0 || wait4(child, &status, 0, &usage) < 0 || status != 0)
        throw Error("a method failed; see above");
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

std::string number(double value, int decimals) {
    return std::isfinite(value) ? mrpt::format("%.*f", decimals, value) : "-";
}

/** Scores poses of cam0 and prints a row. `ms` and `mb`: NaN where they were not measured. */
void printRow(const std::string& name, const Drive& drive,
              const std::vector<Eigen::Isometry3d>& poses, double ms, double mb,
              std::ostream& tsv) {
    if (poses.size() > drive.truth.size())
        throw Error("'" + drive.name + "' has fewer true poses than '" + name + "' has poses");
    const auto end = drive.truth.begin() + static_cast<std::ptrdiff_t>(poses.size());
    const std::vector<Eigen::Isometry3d> truth(drive.truth.begin(), end);
    auto lengths = evaluation::kittiLengths_m();
    const double path = evaluation::pathLength_m(truth);
    if (path < 2 * lengths.front()) lengths = evaluation::suggestedLengths_m(path);
    const auto row = evaluation::score(truth, poses, lengths, 1);
    std::printf("%-18s %-20s %7.1f %9s %9s %9s %9s %9s %7s\n", drive.name.c_str(), name.c_str(),
                row.length_m, number(row.kitti.t_percent, 3).c_str(),
                number(row.kitti.r_deg_per_100m, 3).c_str(), number(row.rpe_m, 4).c_str(),
                number(row.rpe_deg, 4).c_str(), number(ms, 1).c_str(), number(mb, 0).c_str());
    std::fflush(stdout);
    tsv << drive.name << '\t' << name << '\t' << number(row.length_m, 3) << '\t'
        << number(row.kitti.t_percent, 6) << '\t' << number(row.kitti.r_deg_per_100m, 6) << '\t'
        << number(row.rpe_m, 6) << '\t' << number(row.rpe_deg, 6) << '\t' << number(ms, 2) << '\t'
        << number(mb, 1) << std::endl;
}

void measure(const Drive& drive, const Settings& settings, std::ostream& tsv) {
    const fs::path folder = fs::path(settings.out) / drive.name;
    fs::create_directories(folder);
    for (const auto& method : methods()) {
        const auto& wanted = settings.wanted;
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), method.name) == wanted.end())
            continue;
        const std::string poseFile = (folder / (method.name + ".txt")).string();
        const std::string msFile = (folder / (method.name + ".ms")).string();
        const double mb =
            peakMemoryOf([&] { runMethod(method, drive, settings.count, poseFile, msFile); });
        double ms = 0;
        std::ifstream(msFile) >> ms;
        fs::remove(msFile);
        printRow(method.name, drive, io::readTrajectory(poseFile).poses, ms, mb, tsv);
    }
    for (const auto& [name, poses] : settings.others) {
        const std::string file = (fs::path(poses) / (drive.name + ".txt")).string();
        if (!fs::exists(file)) continue;
        auto cam0 = io::lidarToCam0(io::readTrajectory(file), drive.Tr);
        if (settings.count > 0 && cam0.poses.size() > settings.count)
            cam0.poses.resize(settings.count);
        io::writeKitti(cam0, (folder / (name + ".txt")).string());
        printRow(name, drive, cam0.poses, NAN, NAN, tsv);
    }
}

Settings settingsOf(int argc, char** argv, std::vector<std::string>& drives) {
    Settings settings;
    const auto known = methods();
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&]() -> std::string {
            if (i + 1 == argc) throw Error(word + " wants a value");
            return argv[++i];
        };
        if (word == "-o") {
            settings.out = value();
        } else if (word == "--count") {
            settings.count = std::stoul(value());
        } else if (word == "--method") {
            settings.wanted.push_back(value());
            if (std::none_of(known.begin(), known.end(), [&](const Method& method) {
                    return method.name == settings.wanted.back();
                }))
                throw Error("there is no method '" + settings.wanted.back() + "'");
        } else if (word == "--est") {
            const std::string text = value();
            const auto equals = text.find('=');
            if (equals == std::string::npos || equals == 0) throw Error("--est wants NAME=DIR");
            settings.others.emplace_back(text.substr(0, equals), text.substr(equals + 1));
        } else {
            drives.push_back(word);
        }
    }
    if (settings.out.empty() || drives.empty()) throw Error("wanted: -o OUTDIR DRIVE.rawlog...");
    return settings;
}
}  // namespace

int main(int argc, char** argv) try {
    std::vector<std::string> drives;
    const Settings settings = settingsOf(argc, argv, drives);
    fs::create_directories(settings.out);
    std::ofstream tsv(fs::path(settings.out) / "baselines.tsv");
    tsv << "drive\tmethod\tlength_m\tt_percent\tr_deg_per_100m\trpe_m\trpe_deg\tms_per_scan\tpeak_"
           "mb"
        << std::endl;
    std::printf("%-18s %-20s %7s %9s %9s %9s %9s %9s %7s\n", "drive", "method", "m", "transl. %",
                "deg/100 m", "RPE m", "RPE deg", "ms/scan", "MB");
    for (const auto& rawlog : drives) measure(openDrive(rawlog), settings, tsv);
    if (!tsv.flush()) throw Error("cannot write baselines.tsv");
} catch (const std::exception& e) {
    std::fprintf(stderr, "benchmark_baselines: %s\n", e.what());
    return 1;
}
