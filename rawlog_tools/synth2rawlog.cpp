// synth2rawlog: a drive through a made-up world, with ground truth, as an MRPT rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>

#include "cli.h"
#include "delio/version.h"
#include "drive.h"
#include "drive_writer.h"
#include "make_scene.h"
#include "overlap.h"

namespace {
using namespace delio;
using namespace delio::synth;

std::optional<SensorModel> findSensor(const std::string& option) {
    for (auto& model : sensorModels())
        if (model.option == option) return model;
    return std::nullopt;
}

std::string listed(const std::vector<std::string>& names, const std::string& separator = ", ") {
    std::string list;
    for (const auto& name : names) list += (list.empty() ? "" : separator) + name;
    return list;
}

std::string choiceOf(const std::vector<std::string>& names) { return listed(names, "|"); }

std::vector<std::string> sensorNames() {
    std::vector<std::string> names;
    for (const auto& model : sensorModels()) names.push_back(model.option);
    return names;
}

std::string sensorOptions() { return listed(sensorNames()); }

std::string sceneOptions() { return listed(sceneNames()); }

const std::vector<std::string> kMotions = {"vehicle", "handheld"};

Gait gaitOf(const std::string& motion) {
    return motion == "handheld" ? Gait::kHandheld : Gait::kVehicle;
}

const std::vector<std::string> kStarts = {"rest", "moving"};

Start startOf(const std::string& name) {
    if (name.empty()) return Start::kOfSeed;
    return name == "rest" ? Start::kRest : Start::kMoving;
}

bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/** The command line. */
struct Arguments {
    TCLAP::CmdLine cmd{"a drive through a made-up world, with ground truth", ' ', kVersion};
    TCLAP::ValueArg<std::string> output{"o",          "output", "Rawlog to write", true, "",
                                        "OUT.rawlog", cmd};
    TCLAP::ValueArg<std::string> scene{
        "", "scene", "World to drive through", true, "", choiceOf(sceneNames()), cmd};
    TCLAP::ValueArg<int> scans{"", "scans", "Number of scans, ten a second", true, 0, "N", cmd};
    TCLAP::ValueArg<int> seed{"", "seed", "Another seed, another drive", false, 1, "S", cmd};
    TCLAP::ValueArg<int> driveSeed{
        "",
        "drive-seed",
        "Another drive through the world of --seed: its speed, the traffic and the noise; default: "
        "that of --seed",
        false,
        1,
        "S",
        cmd};
    TCLAP::SwitchArg reverse{"", "reverse",
                             "The same road the other way, in its other lane, from where the drive "
                             "would end; for a vehicle",
                             cmd};
    TCLAP::ValueArg<std::string> trajectory{
        "",
        "trajectory",
        "KITTI poses (cam0, 12 numbers a line, ten a second) to drive along: at scan i the vehicle "
        "is where pose i is, seen from above; heights, pitch and roll are those of the made-up "
        "ground. The drive ends where the poses end. For urban, rural and highway",
        false,
        "",
        "POSES.txt",
        cmd};
    TCLAP::ValueArg<std::string> motion{
        "",
        "motion",
        "handheld: carried at walking speed, 1.3 m/s at most (along --trajectory at the "
        "speed of its poses), and swinging by 15 deg at 1.5 Hz about each axis",
        false,
        kMotions.front(),
        choiceOf(kMotions),
        cmd};
    TCLAP::ValueArg<std::string> start{
        "",
        "start",
        "How the drive begins; default: as the seed has it. rest: standing, up to its speed within "
        "2 s; moving: where it is fast for the first time. For a vehicle without --trajectory",
        false,
        "",
        choiceOf(kStarts),
        cmd};
    TCLAP::ValueArg<std::string> mount{
        "",
        "mount",
        "How the sensor is turned on its vehicle, in degrees: 0,25,0 looks 25 deg down ahead, "
        "90,0,0 lies on its side. The rays stay those of an upright sensor: points, calibration "
        "and truth are told in the turned frame",
        false,
        "0,0,0",
        "ROLL,PITCH,YAW",
        cmd};
    TCLAP::ValueArg<std::string> sensor{
        "", "sensor", "Sensor", false, "hdl64e", choiceOf(sensorNames()), cmd};
    TCLAP::ValueArg<double> noise{
        "", "noise", "Range noise, standard deviation in metres", false, 0.01, "M", cmd};
    TCLAP::ValueArg<double> ringBias{
        "",    "ring-bias", "Constant range error of each laser, standard deviation in metres",
        false, 0,           "M",
        cmd};
    TCLAP::ValueArg<int> movers{"",
                                "movers",
                                "Cars, cyclists and pedestrians near the vehicle; in forest and "
                                "indoor: people, who indoors walk along with the sensor",
                                false,
                                0,
                                "N",
                                cmd};
    TCLAP::SwitchArg distort{"", "distort",
                             "Leave the vehicle's motion in the scans; OUT_Images/*.time: when "
                             "each point was measured, float32 seconds from the scan's stamp",
                             cmd};
    TCLAP::SwitchArg labels{"", "labels", "OUT_Images/*.label: uint8 a point, 1 where it moves",
                            cmd};
    TCLAP::ValueArg<double> drop{"",  "drop-rate", "Share of scans that are lost", false, 0,
                                 "R", cmd};
    TCLAP::ValueArg<double> repeat{
        "", "repeat-rate", "Share of scans that bring the points of the scan before", false, 0, "R",
        cmd};
    TCLAP::ValueArg<double> empty{"",  "empty-rate", "Share of scans without points", false, 0,
                                  "R", cmd};
    TCLAP::SwitchArg embed{"", "embed", "Keep the points in the rawlog, not in OUT_Images/", cmd};
    TCLAP::ValueArg<int> threads{"", "threads", "Threads to use; 0: all", false, 0, "N", cmd};
    TCLAP::SwitchArg force{"", "force", "Overwrite what exists", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "All the text of errors", cmd};
};

/** A distance that has to be 0 or more. */
bool isMetres(double value) { return value >= 0 && std::isfinite(value); }

bool isRate(double value) { return value >= 0 && value < 1; }

/** Why a scene cannot be made as asked; empty: it can. */
std::string faultInScene(Arguments& args) {
    const std::string& scene = args.scene.getValue();
    if (!isOneOf(sceneNames(), scene))
        return "there is no scene '" + scene + "'; there are: " + sceneOptions();
    if (!args.trajectory.isSet()) return "";
    if (args.trajectory.getValue().empty()) return "--trajectory needs the name of a file";
    if (!takesTrajectory(scene))
        return "--trajectory does not go with --scene " + scene + ", which has a path of its own";
    return "";
}

/** The same of how the sensor is moved. */
std::string faultInMotion(Arguments& args) {
    const std::string &motion = args.motion.getValue(), &start = args.start.getValue();
    if (!isOneOf(kMotions, motion))
        return "there is no motion '" + motion + "'; there is: " + listed(kMotions);
    if (!mountIn(args.mount.getValue()))
        return "--mount wants ROLL,PITCH,YAW in degrees, not '" + args.mount.getValue() + "'";
    if (args.reverse.isSet() && gaitOf(motion) != Gait::kVehicle)
        return "--reverse does not go with --motion " + motion;
    if (args.reverse.isSet() && args.start.isSet())
        return "--reverse does not go with --start, which says how the drive forward begins";
    if (!args.start.isSet()) return "";
    if (!isOneOf(kStarts, start))
        return "there is no start '" + start + "'; there is: " + listed(kStarts);
    if (args.trajectory.isSet())
        return "--start does not go with --trajectory, which says how the drive begins";
    if (gaitOf(motion) != Gait::kVehicle) return "--start does not go with --motion " + motion;
    return "";
}

/** The same of sensor and drive. */
std::string faultInDrive(Arguments& args) {
    if (!findSensor(args.sensor.getValue()))
        return "there is no sensor '" + args.sensor.getValue() + "'; there is: " + sensorOptions();
    if (args.scans.getValue() < 1) return "--scans has to be 1 or more";
    if (args.seed.getValue() < 0) return "--seed has to be 0 or more";
    if (args.driveSeed.getValue() < 0) return "--drive-seed has to be 0 or more";
    if (!isMetres(args.noise.getValue())) return "--noise has to be 0 or more metres";
    if (!isMetres(args.ringBias.getValue())) return "--ring-bias has to be 0 or more metres";
    if (args.movers.getValue() < 0) return "--movers has to be 0 or more";
    for (auto* rate : {&args.drop, &args.repeat, &args.empty})
        if (!isRate(rate->getValue()))
            return "--" + rate->getName() + " has to be 0 or more and below 1";
    if (args.threads.getValue() < 0) return "--threads has to be 0 or more";
    if (args.threads.getValue() > static_cast<int>(cli::kMostThreads))
        return "--threads has to be " + std::to_string(cli::kMostThreads) + " or less; 0: all";
    return "";
}

DriveRequest requestOf(Arguments& args) {
    DriveRequest request;
    request.output = args.output.getValue();
    request.sensor = *findSensor(args.sensor.getValue());
    request.scanner.noise_m = args.noise.getValue();
    request.scanner.ringBias_m = args.ringBias.getValue();
    request.scanner.seed = static_cast<std::uint64_t>(
        args.driveSeed.isSet() ? args.driveSeed.getValue() : args.seed.getValue());
    request.scanner.threads = args.threads.getValue();
    if (request.scanner.threads == 0)
        request.scanner.threads =
            static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    request.mount = *mountIn(args.mount.getValue());
    request.movers = static_cast<std::size_t>(args.movers.getValue());
    request.faults = {args.drop.getValue(), args.repeat.getValue(), args.empty.getValue()};
    request.distort = args.distort.getValue();
    request.labels = args.labels.getValue();
    request.embed = args.embed.getValue();
    request.force = args.force.getValue();
    return request;
}

/** What is carried by hand has no roof under it, and tells what is near. */
void suit(DriveRequest& request, const Carrier& carrier) {
    request.scanner.onVehicle = carrier.isVehicle;
    request.sensor.minRange_m = std::min(request.sensor.minRange_m, carrier.nearest_m);
}

int makeDrive(Arguments& args) {
    std::string fault = faultInScene(args);
    if (fault.empty()) fault = faultInMotion(args);
    if (fault.empty()) fault = faultInDrive(args);
    if (!fault.empty()) {
        cli::inform(fault + "; see --help");
        return cli::kExitBadCommandLine;
    }
    cli::catchInterrupts();
    DriveRequest request = requestOf(args);
    cli::refuseOverlap({args.trajectory.getValue()}, io::RawlogWriter::outputsOf(request.output));
    const auto count = static_cast<std::size_t>(args.scans.getValue());
    const Start start = startOf(args.start.getValue());
    const auto world =
        makeScene({args.scene.getValue(), static_cast<std::uint64_t>(args.seed.getValue()),
                   count + scansBefore(start), args.trajectory.getValue(), lidarToCam0()});
    Drive drive(world->road(), count, request.scanner.seed, gaitOf(args.motion.getValue()), start);
    if (args.reverse.isSet()) drive.turnBack();
    suit(request, drive.carrier());
    if (drive.scans() < count)
        cli::warn("the trajectory ends after " + std::to_string(drive.scans()) + " of " +
                  std::to_string(count) + " scans; so does the drive");
    return DriveWriter(request, *world, drive).write();
}

cli::HelpText help() {
    cli::HelpText help;
    help.writes = {
        {"OUT.rawlog", "a CObservationPointCloud a scan"},
        {"OUT_Images/",
         "their points, x y z intensity as float32 (not with --embed); .ring, .time, .label: a "
         "value a point"},
        {"OUT.times.txt, OUT.calib.txt, OUT.poses.txt", "as KITTI's; the poses are exact"},
        {"OUT.origin.txt", "where cam0 begins in the world"},
        {"OUT.faults.tsv", "scans that were lost, repeated or empty"},
        {"OUT.meta.yaml", "the sensor, and what was done to the points"}};
    help.examples = {{{"synth2rawlog -o town.rawlog --scene urban --scans 100 --movers 20",
                       "A town with traffic"},
                      {"synth2rawlog -o room.rawlog --scene indoor --scans 50 --sensor vlp16",
                       "A small sensor in rooms"}}};
    help.interrupted = "nothing is written";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments args;
    return cli::run(args.cmd, help(), argc, argv, args.verbose, [&] { return makeDrive(args); });
}
