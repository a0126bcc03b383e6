// synth2rawlog: a drive through a made-up world, with ground truth, as an MRPT rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>
#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include "cli.h"
#include "delio/io/rawlog_writer.h"
#include "delio/io/trajectory.h"
#include "delio/version.h"
#include "drive.h"
#include "make_scene.h"
#include "scanner.h"
#include "tile_window.h"

namespace {
using namespace delio;
using namespace delio::synth;
using mrpt::poses::CPose3D;

// KITTI's axes (x right, y down, z forward) and about its lever arm from LiDAR to cam0.
const char* const kCalib = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";
const char* const kLabel = "velodyne";

struct Request {
    std::string output;
    std::size_t scans = 0;
    std::uint64_t seed = 0;
    SensorModel sensor;
    double noise_m = 0;
    bool embed = false, force = false;
    int threads = 0;
};

CPose3D lidarToCam0() {
    CPose3D Tr;
    mrpt::math::CMatrixDouble33 R;
    R.asEigen() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    Tr.setRotationMatrix(R);
    Tr.y(-0.08);
    Tr.z(-0.27);
    return Tr;
}

/** The LiDAR's poses relative to its first, as cam0's: KITTI's poses.txt. */
std::string posesText(const Drive& drive) {
    io::Trajectory lidar;
    const Eigen::Isometry3d first = drive.lidarPose(0);
    for (std::size_t i = 0; i < drive.scans(); ++i) {
        const Eigen::Isometry3d pose = first.inverse() * drive.lidarPose(i);
        CPose3D relative;
        if (i > 0) {  // the first is the identity to the last digit
            relative.setRotationMatrix(mrpt::math::CMatrixDouble33(pose.rotation()));
            relative.x(pose.translation().x());
            relative.y(pose.translation().y());
            relative.z(pose.translation().z());
        }
        lidar.poses.push_back(relative);
    }
    std::string text;
    for (const auto& pose : io::lidarToCam0(lidar, lidarToCam0()).poses) text += io::kittiRow(pose);
    return text;
}

std::string timeRow(std::size_t scan) {
    char row[32];
    std::snprintf(row, sizeof(row), "%.6f\n", kScanPeriod_s * static_cast<double>(scan));
    return row;
}

int writeDrive(const Request& request, const Scene& scene) {
    const Drive drive(scene.road(), request.scans, request.seed);
    if (drive.scans() < request.scans)
        cli::warn("the trajectory ends after " + std::to_string(drive.scans()) + " of " +
                  std::to_string(request.scans) + " scans; so does the drive");
    RayCaster caster;
    TileWindow window(scene, caster);
    const Scanner scanner(caster, request.sensor, request.noise_m, request.seed, request.threads);
    io::RawlogWriter writer(request.output, kLabel, request.embed, request.force);
    std::string times;
    {
        cli::Progress progress("simulating", drive.scans());
        for (std::size_t i = 0; i < drive.scans(); ++i) {
            if (cli::interrupted()) return cli::kExitInterrupted;
            window.moveTo(drive.station(i));
            writer.add(kScanPeriod_s * static_cast<double>(i), io::kDriveEpoch_s,
                       scanner.scan(drive.lidarPose(i), i));
            times += timeRow(i);
            progress.update(i + 1);
        }
    }
    io::DriveMeta meta;
    meta.sensorModel = request.sensor.name;
    meta.source = "synthetic";
    meta.epoch_s = io::kDriveEpoch_s;
    meta.generator = std::string("synth2rawlog 1 (delio ") + kVersion + ")";
    writer.finish(meta, times, kCalib, posesText(drive));
    cli::inform("wrote " + std::to_string(writer.scans()) + " scans, " +
                std::to_string(std::lround(drive.station(drive.scans() - 1))) + " m, to '" +
                request.output + "'");
    return cli::kExitSuccess;
}

std::optional<SensorModel> findSensor(const std::string& option) {
    for (auto& model : sensorModels())
        if (model.option == option) return model;
    return std::nullopt;
}

std::string sensorOptions() {
    std::string names;
    for (const auto& model : sensorModels()) names += (names.empty() ? "" : ", ") + model.option;
    return names;
}

std::string sceneOptions() {
    std::string names;
    for (const auto& name : sceneNames()) names += (names.empty() ? "" : ", ") + name;
    return names;
}

int badUsage(const std::string& what) {
    cli::inform(what + "; see --help");
    return cli::kExitBadCommandLine;
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("synth2rawlog: a drive through a made-up world, with ground truth", ' ',
                       kVersion);
    TCLAP::ValueArg<std::string> output("o", "output", "Rawlog to write", true, "", "OUT.rawlog",
                                        cmd);
    TCLAP::ValueArg<std::string> scene("", "scene", "Scene: " + sceneOptions(), true, "", "NAME",
                                       cmd);
    TCLAP::ValueArg<int> scans("", "scans", "Number of scans, ten a second", true, 0, "N", cmd);
    TCLAP::ValueArg<int> seed("", "seed", "Another seed, another drive", false, 1, "S", cmd);
    TCLAP::ValueArg<std::string> trajectory(
        "", "trajectory",
        "KITTI poses (cam0, 12 numbers a line, ten a second) to drive along: at scan i the vehicle "
        "is where pose i is, seen from above; heights, pitch and roll are those of the made-up "
        "ground. The drive ends where the poses end. For urban, rural and highway",
        false, "", "POSES.txt", cmd);
    TCLAP::ValueArg<std::string> sensor("", "sensor", "Sensor: " + sensorOptions(), false, "hdl64e",
                                        "NAME", cmd);
    TCLAP::ValueArg<double> noise("", "noise", "Range noise, standard deviation in metres", false,
                                  0.02, "M", cmd);
    TCLAP::SwitchArg embed("", "embed", "Keep the points in the rawlog, not in OUT_Images/", cmd);
    TCLAP::ValueArg<int> threads("", "threads", "Threads; 0: one per core", false, 0, "N", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite what exists", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "Say more", cmd);

    return cli::run(cmd, argc, argv, verbose, [&] {
        const auto names = sceneNames();
        if (std::find(names.begin(), names.end(), scene.getValue()) == names.end())
            return badUsage("there is no scene '" + scene.getValue() +
                            "'; there are: " + sceneOptions());
        if (trajectory.isSet() && trajectory.getValue().empty())
            return badUsage("--trajectory needs the name of a file");
        if (trajectory.isSet() && !takesTrajectory(scene.getValue()))
            return badUsage("--trajectory does not go with --scene " + scene.getValue() +
                            ", which has a path of its own");
        const auto model = findSensor(sensor.getValue());
        if (!model)
            return badUsage("there is no sensor '" + sensor.getValue() +
                            "'; there is: " + sensorOptions());
        if (scans.getValue() < 1) return badUsage("--scans has to be 1 or more");
        if (seed.getValue() < 0) return badUsage("--seed has to be 0 or more");
        if (!(noise.getValue() >= 0) || !std::isfinite(noise.getValue()))
            return badUsage("--noise has to be 0 or more metres");
        if (threads.getValue() < 0) return badUsage("--threads has to be 0 or more");
        cli::catchInterrupts();
        Request request{output.getValue(),
                        static_cast<std::size_t>(scans.getValue()),
                        static_cast<std::uint64_t>(seed.getValue()),
                        *model,
                        noise.getValue(),
                        embed.getValue(),
                        force.getValue(),
                        threads.getValue()};
        if (request.threads == 0)
            request.threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
        const SceneRequest world{scene.getValue(), request.seed, request.scans,
                                 trajectory.getValue(), lidarToCam0()};
        return writeDrive(request, *makeScene(world));
    });
}
