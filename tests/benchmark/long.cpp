// A drive without an end: benchmark_long [--scans N] [--scene NAME] [--sensor NAME] [--seed S]
// [--map] [--rows K]. Scans are made as they are wanted and go through run::Run; K times on the way
// it prints time, memory and the error of the latest kilometre: all of them have to stay as they
// are. What grows is what outputs need: rows, poses, graph, submaps; with --map its keyframes.
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numeric>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/formats/drive_meta.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/run/run.h"
#include "drive.h"
#include "make_scene.h"
#include "scanner.h"
#include "tile_window.h"

namespace {
using namespace delio;

synth::SensorModel sensorOf(const std::string& name) {
    for (const auto& model : synth::sensorModels())
        if (model.option == name) return model;
    throw Error("unknown sensor '" + name + "'");
}

/** A synthetic drive, scan by scan. */
class Source {
 public:
    Source(const synth::SceneRequest& request, const std::string& sensor)
        : world_(synth::makeScene(request)),
          drive_(world_->road(), request.scans, request.seed),
          sensor_(sensorOf(sensor)),
          window_(*world_, caster_),
          scanner_(caster_, nullptr, sensor_, {}) {}

    Scan scan(std::size_t number) {
        window_.moveTo(drive_.station(number));
        const auto seen = scanner_.scan(synth::sweepOf(drive_, number, sensor_, true, 1), number);
        auto points = mrpt::maps::CPointsMapXYZI::Create();
        points->resize(seen.size());
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const float* p = &seen.xyzi[4 * i];
            points->setPointFast(i, p[0], p[1], p[2]);
            points->setPointIntensity(i, p[3]);
        }
        Scan scan;
        scan.points = points;
        scan.rings = seen.ring;
        scan.times_s = seen.time_s;
        scan.index = number;
        scan.stamp_s = synth::kScanPeriod_s * static_cast<double>(number);
        scan.time = mrpt::Clock::fromDouble(io::kDriveEpoch_s + scan.stamp_s);
        return scan;
    }
    Eigen::Isometry3d truth(std::size_t number) const {
        return drive_.lidarPose(0).inverse() * drive_.lidarPose(number);
    }

 private:
    std::unique_ptr<synth::Scene> world_;
    synth::Drive drive_;
    synth::SensorModel sensor_;
    synth::RayCaster caster_;
    synth::TileWindow window_;
    synth::Scanner scanner_;
};

double residentMegabytes() {
    std::size_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return static_cast<double>(resident) * 4096 / (1 << 20);
}

/** Where the latest `km` ended beside where it should have, in % of it; 0 before. */
double errorOfLatest(const std::vector<Eigen::Isometry3d>& poses, const Source& source,
                     double path_m) {
    const std::size_t last = poses.size() - 1;
    std::size_t first = last;
    double driven_m = 0;
    while (first > 0 && driven_m < path_m) {
        driven_m += (poses[first].translation() - poses[first - 1].translation()).norm();
        --first;
    }
    if (driven_m < path_m) return 0;
    const Eigen::Isometry3d found = poses[first].inverse() * poses[last];
    const Eigen::Isometry3d wanted = source.truth(first).inverse() * source.truth(last);
    return 100 * (wanted.inverse() * found).translation().norm() / driven_m;
}

void drive(Source& source, std::size_t scans, std::size_t rows, bool map) {
    io::DriveMeta meta;
    meta.motionCompensated = false;
    run::RunSettings settings;
    settings.map = map;
    run::Run run(Options::forDrive("accurate", meta), settings);
    std::vector<double> ms;
    std::printf("%9s %9s %9s %9s %9s %12s %9s\n", "scans", "km away", "ms/scan", "worst", "MB",
                "% last km", "predicted");
    for (std::size_t i = 0; i < scans; ++i) {
        const auto row = run.process(source.scan(i));
        ms.push_back(row.total_ms());
        if ((i + 1) * rows / scans == i * rows / scans) continue;
        const auto& poses = run.odometry().poses;
        std::printf("%9zu %9.2f %9.2f %9.1f %9.1f %12.3f %9zu\n", i + 1,
                    poses.back().translation().norm() / 1000,
                    std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(ms.size()),
                    *std::max_element(ms.begin(), ms.end()), residentMegabytes(),
                    errorOfLatest(poses, source, 1000), run.record().predicted());
        std::fflush(stdout);
        ms.clear();
    }
}
}  // namespace

int main(int argc, char** argv) {
    try {
        TCLAP::CmdLine cmd("Time, memory and error of a drive without an end");
        TCLAP::ValueArg<unsigned> scans("", "scans", "", false, 100000, "N", cmd);
        TCLAP::ValueArg<unsigned> rows("", "rows", "Lines to print", false, 20, "K", cmd);
        TCLAP::ValueArg<unsigned> seed("", "seed", "", false, 1, "S", cmd);
        TCLAP::ValueArg<std::string> scene("", "scene", "", false, "rural", "NAME", cmd);
        TCLAP::ValueArg<std::string> sensor("", "sensor", "", false, "vlp16", "NAME", cmd);
        TCLAP::SwitchArg map("", "map", "Build a map, too", cmd);
        cmd.parse(argc, argv);
        Source source({scene.getValue(), seed.getValue(), scans.getValue(), "",
                       Eigen::Isometry3d::Identity()},
                      sensor.getValue());
        drive(source, scans.getValue(), rows.getValue(), map.getValue());
        return 0;
    } catch (const std::exception& e) {
        std::cerr << "benchmark_long: " << plainMessage(e) << '\n';
        return 1;
    }
}
