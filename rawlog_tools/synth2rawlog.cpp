// synth2rawlog: a drive through a made-up world, with ground truth, as an MRPT rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>
#include <tuple>
#include <utility>

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

/** First scan and number of scans, both 1 or more, from "FIRST,COUNT". */
std::optional<std::pair<std::size_t, std::size_t>> gapIn(const std::string& text) {
    std::istringstream stream(text);
    int first = 0, count = 0;
    char comma = 0;
    if (!(stream >> first >> comma >> count) || comma != ',' || first < 1 || count < 1)
        return std::nullopt;
    if (!stream.eof()) return std::nullopt;
    return std::pair{static_cast<std::size_t>(first), static_cast<std::size_t>(count)};
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
    TCLAP::CmdLine cmd{"generates a drive through a synthetic world with ground truth", ' ',
                       kVersion};
    TCLAP::ValueArg<std::string> output{"o",          "output", "Rawlog to write", true, "",
                                        "OUT.rawlog", cmd};
    TCLAP::ValueArg<std::string> scene{
        "", "scene", "Synthetic world", true, "", choiceOf(sceneNames()), cmd};
    TCLAP::ValueArg<int> scans{"", "scans", "Number of scans (10 per second)", true, 0, "N", cmd};
    TCLAP::ValueArg<int> seed{"", "seed", "Random seed of world and drive", false, 1, "S", cmd};
    TCLAP::ValueArg<int> driveSeed{"",
                                   "drive-seed",
                                   "Random seed of speed, traffic and noise in the world of "
                                   "--seed; default: the value of --seed",
                                   false,
                                   1,
                                   "S",
                                   cmd};
    TCLAP::ValueArg<int> parkedSeed{"",
                                    "parked-seed",
                                    "Random seed of the cars parked in the world of --seed (urban, "
                                    "loop); 0: none; default: the value of --seed",
                                    false,
                                    0,
                                    "S",
                                    cmd};
    TCLAP::ValueArg<double> epoch{
        "",    "epoch", "Unix time of scan 0: stamps are Unix times; default: they start at 0",
        false, 0,       "UNIX_S",
        cmd};
    TCLAP::SwitchArg reverse{
        "", "reverse",
        "Drive the same road in the opposite direction, in the other lane (vehicle only)", cmd};
    TCLAP::ValueArg<std::string> trajectory{
        "",
        "trajectory",
        "KITTI poses (cam0, 12 numbers per line, 10 per second) to follow in x and y; height, "
        "pitch and roll follow the synthetic ground. The drive ends with the poses. For urban, "
        "rural and highway",
        false,
        "",
        "POSES.txt",
        cmd};
    TCLAP::ValueArg<std::string> motion{
        "",
        "motion",
        "handheld: carried at up to 1.3 m/s (with --trajectory at the speed of its poses), "
        "swinging by 15 deg at 1.5 Hz about each axis",
        false,
        kMotions.front(),
        choiceOf(kMotions),
        cmd};
    TCLAP::ValueArg<std::string> start{
        "",
        "start",
        "Initial motion; default: random. rest: starts standing and reaches its speed within 2 s; "
        "moving: starts at speed. For a vehicle without --trajectory",
        false,
        "",
        choiceOf(kStarts),
        cmd};
    TCLAP::ValueArg<std::string> mount{
        "",
        "mount",
        "Orientation of the sensor frame on the vehicle, degrees: 0,25,0 looks 25 deg down, 90,0,0 "
        "lies on its side. The rays are those of an upright sensor; points, calibration and ground "
        "truth are given in the rotated frame",
        false,
        "0,0,0",
        "ROLL,PITCH,YAW",
        cmd};
    TCLAP::ValueArg<std::string> sensor{
        "", "sensor", "Sensor", false, "hdl64e", choiceOf(sensorNames()), cmd};
    TCLAP::ValueArg<std::string> second{
        "",
        "second",
        "Also record a second sensor of that kind (label second) at this pose in the frame of the "
        "first one (label velodyne), metres and degrees",
        false,
        "",
        "X,Y,Z,YAW,PITCH,ROLL",
        cmd};
    TCLAP::ValueArg<std::string> ownBox{
        "",
        "own-box",
        "Part of the own vehicle that the sensor sees: a box in the frame of the upright LiDAR, "
        "metres",
        false,
        "",
        "XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX",
        cmd};
    TCLAP::ValueArg<double> imu{
        "",    "imu", "Also record an IMU at so many samples a second (CObservationIMU, label imu)",
        false, 0,     "HZ",
        cmd};
    TCLAP::ValueArg<std::string> imuGrade{"",    "imu-grade",         "Its noise and bias",
                                          false, imuGrades().front(), choiceOf(imuGrades()),
                                          cmd};
    TCLAP::ValueArg<double> imuBias{
        "",    "imu-bias", "Its bias at the start about each axis, deg/s; default: of its grade",
        false, 0,          "DEG_S",
        cmd};
    TCLAP::ValueArg<double> imuOffset{
        "", "imu-offset", "Seconds by which its stamps are late", false, 0, "S", cmd};
    TCLAP::ValueArg<std::string> imuMount{
        "",
        "imu-mount",
        "Its orientation on the vehicle, degrees; the rawlog does not contain it",
        false,
        "0,0,0",
        "ROLL,PITCH,YAW",
        cmd};
    TCLAP::ValueArg<double> odometry{
        "",
        "odometry",
        "Also record wheel odometry, 50 poses per second (CObservationOdometry, label odometry); "
        "0.01: its distances are 1 % too long",
        false,
        0,
        "SCALE_ERROR",
        cmd};
    TCLAP::ValueArg<std::string> slip{
        "",
        "slip",
        "Time in which the wheels slip, seconds, and the part by which their distances grow",
        false,
        "",
        "START,DURATION,PART",
        cmd};
    TCLAP::ValueArg<double> noise{
        "", "noise", "Standard deviation of the range noise, metres", false, 0.01, "M", cmd};
    TCLAP::ValueArg<double> ringBias{
        "",    "ring-bias", "Standard deviation of each laser's constant range error, metres",
        false, 0,           "M",
        cmd};
    TCLAP::ValueArg<int> movers{
        "",
        "movers",
        "Number of cars, cyclists and pedestrians near the vehicle; in forest and indoor: of "
        "people, who indoors walk along with the sensor",
        false,
        0,
        "N",
        cmd};
    TCLAP::SwitchArg distort{"", "distort",
                             "Do not motion-compensate the scans; OUT_Images/*.time holds each "
                             "point's time, float32 seconds from the scan's stamp",
                             cmd};
    TCLAP::SwitchArg labels{"", "labels",
                            "Write OUT_Images/*.label: uint8 per point, 1 for dynamic points", cmd};
    TCLAP::ValueArg<double> drop{"",  "drop-rate", "Fraction of scans that are lost", false, 0,
                                 "R", cmd};
    TCLAP::ValueArg<std::string> gap{
        "",    "gap", "Lose COUNT scans in a row, from scan FIRST on (1 or more)",
        false, "",    "FIRST,COUNT",
        cmd};
    TCLAP::ValueArg<double> repeat{"",
                                   "repeat-rate",
                                   "Fraction of scans that repeat the points of the scan before",
                                   false,
                                   0,
                                   "R",
                                   cmd};
    TCLAP::ValueArg<double> empty{"",  "empty-rate", "Fraction of scans without points", false, 0,
                                  "R", cmd};
    TCLAP::ValueArg<double> gnss{"",
                                 "gnss",
                                 "Add GNSS fixes, 5 per second, with this standard deviation (m; "
                                 "twice of it in height); OUT.gnss.csv holds the truth",
                                 false,
                                 0,
                                 "M",
                                 cmd};
    TCLAP::ValueArg<double> gnssJumps{
        "",  "gnss-jumps", "Fraction of fixes that are wrong by 20 m, for 3 s at a time", false, 0,
        "R", cmd};
    TCLAP::ValueArg<std::string> gnssGap{
        "", "gnss-gap", "Times without fixes, seconds", false, "", "FROM,TO", cmd};
    TCLAP::ValueArg<std::string> antenna{
        "",    "antenna",      "GNSS antenna in the frame of the upright LiDAR, metres",
        false, "-0.8,0.3,0.5", "X,Y,Z",
        cmd};
    TCLAP::SwitchArg embed{"", "embed", "Store the points in the rawlog instead of OUT_Images/",
                           cmd};
    TCLAP::ValueArg<int> threads{"",  "threads", "Number of threads; 0: all cores", false, 0,
                                 "N", cmd};
    TCLAP::SwitchArg force{"", "force", "Overwrite existing files", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "Print full error texts", cmd};
};

/** A distance that has to be 0 or more. */
bool isMetres(double value) { return value >= 0 && std::isfinite(value); }

bool isRate(double value) { return value >= 0 && value < 1; }

/** The receiver asked for. */
std::optional<GnssRequest> gnssOf(Arguments& args) {
    if (!args.gnss.isSet()) return std::nullopt;
    GnssRequest gnss;
    gnss.sigma_m = args.gnss.getValue();
    gnss.jumps = args.gnssJumps.getValue();
    gnss.antenna = Eigen::Vector3d(cli::numbersIn(args.antenna.getValue(), 3).data());
    if (args.gnssGap.isSet()) {
        const auto gap = cli::numbersIn(args.gnssGap.getValue(), 2);
        gnss.gapFirst_s = gap[0];
        gnss.gapLast_s = gap[1];
    }
    gnss.seed = static_cast<std::uint64_t>(args.driveSeed.isSet() ? args.driveSeed.getValue()
                                                                  : args.seed.getValue());
    return gnss;
}

std::string faultInGnss(Arguments& args) {
    if (!args.gnss.isSet() &&
        (args.gnssJumps.isSet() || args.gnssGap.isSet() || args.antenna.isSet()))
        return "--gnss-jumps, --gnss-gap and --antenna need --gnss";
    if (!isMetres(args.gnss.getValue())) return "--gnss must be at least 0 m";
    if (!isRate(args.gnssJumps.getValue()))
        return "--gnss-jumps must be at least 0 and less than 1";
    if (cli::numbersIn(args.antenna.getValue(), 3).empty())
        return "--antenna needs X,Y,Z in metres";
    if (args.gnssGap.isSet() && cli::numbersIn(args.gnssGap.getValue(), 2).empty())
        return "--gnss-gap needs FROM,TO in seconds";
    return "";
}

/** Message about invalid arguments of a scene; empty if they are valid. */
std::string faultInScene(Arguments& args) {
    const std::string& scene = args.scene.getValue();
    if (!isOneOf(sceneNames(), scene))
        return "unknown scene '" + scene + "'; choose one of: " + sceneOptions();
    if (args.parkedSeed.isSet() && !hasParkedCars(scene))
        return "--parked-seed needs --scene urban or loop";
    if (args.parkedSeed.getValue() < 0) return "--parked-seed must be at least 0";
    if (!args.trajectory.isSet()) return "";
    if (args.trajectory.getValue().empty()) return "--trajectory needs a file name";
    if (!takesTrajectory(scene))
        return "--trajectory cannot be used with --scene " + scene + ", which has its own path";
    return "";
}

/** The same of how the sensor is moved. */
std::string faultInMotion(Arguments& args) {
    const std::string &motion = args.motion.getValue(), &start = args.start.getValue();
    if (!isOneOf(kMotions, motion))
        return "unknown motion '" + motion + "'; choose one of: " + listed(kMotions);
    if (!mountIn(args.mount.getValue()))
        return "--mount needs ROLL,PITCH,YAW in degrees, not '" + args.mount.getValue() + "'";
    if (args.reverse.isSet() && gaitOf(motion) != Gait::kVehicle)
        return "--reverse cannot be used with --motion " + motion;
    if (args.reverse.isSet() && args.start.isSet())
        return "--reverse and --start exclude each other";
    if (!args.start.isSet()) return "";
    if (!isOneOf(kStarts, start))
        return "unknown start '" + start + "'; choose one of: " + listed(kStarts);
    if (args.trajectory.isSet()) return "--start and --trajectory exclude each other";
    if (gaitOf(motion) != Gait::kVehicle) return "--start cannot be used with --motion " + motion;
    return "";
}

/** Empty: none. */
Eigen::AlignedBox3d ownBoxOf(Arguments& args) {
    const auto box = cli::numbersIn(args.ownBox.getValue(), 6);
    if (box.empty()) return {};
    return {Eigen::Vector3d(box.data()), Eigen::Vector3d(box.data() + 3)};
}

/** The same of sensor and drive. */
std::string faultInDrive(Arguments& args) {
    if (!findSensor(args.sensor.getValue()))
        return "unknown sensor '" + args.sensor.getValue() + "'; choose one of: " + sensorOptions();
    if (args.ownBox.isSet() && ownBoxOf(args).isEmpty())
        return "--own-box needs XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX in metres";
    if (args.scans.getValue() < 1) return "--scans must be at least 1";
    if (args.seed.getValue() < 0) return "--seed must be at least 0";
    if (args.driveSeed.getValue() < 0) return "--drive-seed must be at least 0";
    if (!isMetres(args.noise.getValue())) return "--noise must be at least 0 m";
    if (!isMetres(args.ringBias.getValue())) return "--ring-bias must be at least 0 m";
    if (args.movers.getValue() < 0) return "--movers must be at least 0";
    for (auto* rate : {&args.drop, &args.repeat, &args.empty})
        if (!isRate(rate->getValue()))
            return "--" + rate->getName() + " must be at least 0 and less than 1";
    if (args.gap.isSet() && !gapIn(args.gap.getValue()))
        return "--gap needs FIRST,COUNT, both 1 or more, not '" + args.gap.getValue() + "'";
    constexpr double kFirst_s = 5e8, kLast_s = 4e9;  // what readers take for Unix times
    const double epoch_s = args.epoch.getValue();
    if (args.epoch.isSet() && !(epoch_s >= kFirst_s && epoch_s <= kLast_s))
        return "--epoch must be a Unix time between 5e8 and 4e9 s";
    if (args.threads.getValue() < 0) return "--threads must be 0 or more";
    if (args.threads.getValue() > static_cast<int>(cli::kMostThreads))
        return "--threads must be " + std::to_string(cli::kMostThreads) + " or less (0: all)";
    return "";
}

/** The same of the IMU. */
std::string faultInImu(Arguments& args) {
    constexpr double kMost_hz = 10000, kMostOffset_s = 1;
    for (auto* option : {&args.imuBias, &args.imuOffset})
        if (option->isSet() && !args.imu.isSet()) return "--" + option->getName() + " needs --imu";
    for (auto* option : {&args.imuGrade, &args.imuMount})
        if (option->isSet() && !args.imu.isSet()) return "--" + option->getName() + " needs --imu";
    if (!args.imu.isSet()) return "";
    if (!(args.imu.getValue() >= 1 && args.imu.getValue() <= kMost_hz))
        return "--imu must be between 1 and 10000 Hz";
    if (!imuOfGrade(args.imuGrade.getValue()))
        return "unknown --imu-grade '" + args.imuGrade.getValue() +
               "'; choose one of: " + listed(imuGrades());
    if (!(std::abs(args.imuOffset.getValue()) <= kMostOffset_s))
        return "--imu-offset must be between -1 and 1 s";
    if (!std::isfinite(args.imuBias.getValue())) return "--imu-bias must be a number";
    if (!mountIn(args.imuMount.getValue()))
        return "--imu-mount needs ROLL,PITCH,YAW in degrees, not '" + args.imuMount.getValue() +
               "'";
    return "";
}

std::optional<ImuModel> imuOf(Arguments& args) {
    if (!args.imu.isSet()) return {};
    auto model = imuOfGrade(args.imuGrade.getValue());
    model->rate_hz = args.imu.getValue();
    model->offset_s = args.imuOffset.getValue();
    model->mount = *mountIn(args.imuMount.getValue());
    if (args.imuBias.isSet())
        model->rateBias_radps = args.imuBias.getValue() * 3.14159265358979323846 / 180;
    return model;
}

/** The same of the wheels. */
std::string faultInWheels(Arguments& args) {
    if (args.slip.isSet() && !args.odometry.isSet()) return "--slip needs --odometry";
    if (!(std::abs(args.odometry.getValue()) < 1)) return "--odometry must be between -1 and 1";
    if (!args.slip.isSet()) return "";
    const auto slip = cli::numbersIn(args.slip.getValue(), 3);
    if (slip.empty() || slip[1] < 0 || slip[2] <= -1)
        return "--slip needs START,DURATION,PART: two times in seconds and more than -1";
    return "";
}

std::optional<WheelModel> wheelsOf(Arguments& args) {
    if (!args.odometry.isSet()) return {};
    WheelModel model;
    model.scaleError = args.odometry.getValue();
    if (!args.slip.isSet()) return model;
    const auto slip = cli::numbersIn(args.slip.getValue(), 3);
    model.slipFirst_s = slip[0];
    model.slipLast_s = slip[0] + slip[1];
    model.slip = slip[2];
    return model;
}

std::string faultInSecond(Arguments& args) {
    if (!args.second.isSet()) return "";
    if (cli::numbersIn(args.second.getValue(), 6).empty())
        return "--second needs X,Y,Z,YAW,PITCH,ROLL in metres and degrees";
    if (args.embed.isSet() || args.mount.isSet()) return "--second excludes --embed and --mount";
    return "";
}

std::optional<Eigen::Isometry3d> secondOf(Arguments& args) {
    if (!args.second.isSet()) return {};
    const auto pose = cli::numbersIn(args.second.getValue(), 6);
    Eigen::Isometry3d second = Mount{pose[5], pose[4], pose[3]}.pose();
    second.translation() << pose[0], pose[1], pose[2];
    return second;
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
    if (args.gap.isSet())
        std::tie(request.faults.gapFirst, request.faults.gapScans) = *gapIn(args.gap.getValue());
    request.gnss = gnssOf(args);
    request.distort = args.distort.getValue();
    request.labels = args.labels.getValue();
    if (args.epoch.isSet()) request.epoch_s = args.epoch.getValue();
    request.imu = imuOf(args);
    request.wheels = wheelsOf(args);
    request.second = secondOf(args);
    request.scanner.own.box = ownBoxOf(args);
    request.embed = args.embed.getValue();
    request.force = args.force.getValue();
    return request;
}

/** Hand-held sensors have no vehicle below them and measure near points. */
void suit(DriveRequest& request, const Carrier& carrier) {
    request.scanner.onVehicle = carrier.isVehicle;
    request.sensor.minRange_m = std::min(request.sensor.minRange_m, carrier.nearest_m);
}

int makeDrive(Arguments& args) {
    std::string fault = faultInScene(args);
    if (fault.empty()) fault = faultInMotion(args);
    if (fault.empty()) fault = faultInDrive(args);
    if (fault.empty()) fault = faultInImu(args);
    if (fault.empty()) fault = faultInWheels(args);
    if (fault.empty()) fault = faultInGnss(args);
    if (fault.empty()) fault = faultInSecond(args);
    if (!fault.empty()) {
        cli::inform(fault + "; see --help");
        return cli::kExitBadCommandLine;
    }
    cli::catchInterrupts();
    DriveRequest request = requestOf(args);
    cli::refuseOverlap({args.trajectory.getValue()}, io::RawlogWriter::outputsOf(request.output));
    const auto count = static_cast<std::size_t>(args.scans.getValue());
    const Start start = startOf(args.start.getValue());
    SceneRequest wanted;
    wanted.name = args.scene.getValue();
    wanted.seed = static_cast<std::uint64_t>(args.seed.getValue());
    wanted.scans = count + scansBefore(start);
    if (args.parkedSeed.isSet())
        wanted.parkedSeed = static_cast<std::uint64_t>(args.parkedSeed.getValue());
    wanted.trajectory = args.trajectory.getValue();
    wanted.lidarToCam0 = lidarToCam0();
    const auto world = makeScene(wanted);
    Drive drive(world->road(), count, request.scanner.seed, gaitOf(args.motion.getValue()), start);
    if (args.reverse.isSet()) drive.turnBack();
    suit(request, drive.carrier());
    if (drive.scans() < count)
        cli::warn("--trajectory ends after " + std::to_string(drive.scans()) + " of " +
                  std::to_string(count) + " scans; the drive ends there");
    return DriveWriter(request, *world, drive).write();
}

cli::HelpText help() {
    cli::HelpText help;
    help.writes = {
        {"OUT.rawlog", "one CObservationPointCloud per scan; with --gnss also CObservationGPS"},
        {"OUT_Images/",
         "their points, x y z intensity as float32 (not with --embed); .ring, .time, .label: one "
         "value per point"},
        {"OUT.times.txt, OUT.calib.txt, OUT.poses.txt", "in KITTI's formats; the poses are exact"},
        {"OUT.origin.txt", "pose of cam0 in the world at the first scan"},
        {"OUT.gnss.csv", "with --gnss: true places of the antenna and errors of the fixes"},
        {"OUT.faults.tsv", "lost, repeated and empty scans"},
        {"OUT.imu.yaml", "with --imu: its true orientation, offset and bias"},
        {"OUT.meta.yaml", "sensor model and processing of the points"}};
    help.examples = {{{"synth2rawlog -o town.rawlog --scene urban --scans 100 --movers 20",
                       "A street with traffic"},
                      {"synth2rawlog -o room.rawlog --scene indoor --scans 50 --sensor vlp16",
                       "A 16-ring sensor indoors"}}};
    help.interrupted = "no output is written";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments args;
    return cli::run(args.cmd, help(), argc, argv, args.verbose, [&] { return makeDrive(args); });
}
