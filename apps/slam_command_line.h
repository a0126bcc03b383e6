#pragma once
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "delio/formats/drive_meta.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/run.h"
#include "delio/version.h"
#include "option_sections.h"

namespace delio {
/** Command line of delio-slam. */
struct SlamCommandLine {
    using Text = TCLAP::ValueArg<std::string>;
    using Number = TCLAP::ValueArg<cli::Count>;
    using Switch = TCLAP::SwitchArg;

    /** `runs`: input and output are needed. */
    explicit SlamCommandLine(bool runs)
        : input("i", "input",
                "Recording: rawlog, KITTI folder, folder of clouds, ROS bag, MCAP, pcap, or \"-\" "
                "for a rawlog or pcap from a pipe; udp://[ADDRESS:]PORT for a live sensor; or a "
                "posegraph.g2o to optimise again. Several recordings are joined into one map where "
                "they overlap",
                runs, "IN", cmd),
          output("o", "output", "Folder for the results", runs, "", "OUTDIR", cmd) {}

    TCLAP::CmdLine cmd{"computes the trajectory and map of a LiDAR recording", ' ', kVersion};
    TCLAP::MultiArg<std::string> input;
    Text output;
    Text profile{"",    "profile",  "Preset for all options that you do not set yourself",
                 false, "accurate", cli::profileChoice(),
                 cmd};
    Text config{"c",          "config", "File with options that differ from the profile", false, "",
                "CONFIG.ini", cmd};
    TCLAP::MultiArg<std::string> set{
        "", "set", "Set one option; --print-config lists all of them", false, "section.key=value",
        cmd};
    Switch printConfig{
        "", "print-config",
        "Print all options with their meanings and exit; needs no --input or --output", cmd};
    Number start{"", "start", "First scan to use, counted from 0", false, {}, "N", cmd};
    Number count{"", "count", "Maximum number of scans; 0: all", false, {}, "N", cmd};
    Number every{"", "every", "Use every N-th scan", false, {1}, "N", cmd};
    Text label{
        "",
        "sensor-label",
        "Sensor: label in a rawlog, topic in a bag, port in a pcap, serial number in an .osf, "
        "layout of .bin files; several with commas between them, or \"all\": merged into one; "
        "default: the first sensor; a bag must have only one",
        false,
        "",
        "L",
        cmd};
    Text sensorInfo{
        "",
        "sensor-info",
        "Sensor description for packets: json of an Ouster, calibration file of a Velodyne, table "
        "of beam angles of a Hesai or RoboSense; default: the json next to the recording, what it "
        "holds, or the model's standard calibration",
        false,
        "",
        "FILE",
        cmd};
    Text extrinsics{
        "",
        "extrinsics",
        "Poses of the sensors in the vehicle, instead of the recording's; lines LABEL x "
        "y z yaw pitch roll, metres and degrees; LABEL imu: the IMU's",
        false,
        "",
        "FILE",
        cmd};
    Switch calibrateExtrinsics{
        "", "calibrate-extrinsics",
        "Several sensors: first refine their poses relative to the first one from the drive", cmd};
    Text vehicleBox{"",
                    "vehicle-box",
                    "Ignore points of the own vehicle beyond scan.min_range: in this box of the "
                    "vehicle frame, metres, or in the boxes and sectors of a file",
                    false,
                    "",
                    "XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX|FILE",
                    cmd};
    Text images{"", "images", "Folder with the rawlog's external files", false, "", "DIR", cmd};
    Number threads{"", "threads", "Number of threads; 0: all cores", false, {}, "N", cmd};
    Text truth{"",
               "ground-truth",
               "Ground-truth poses; default: IN.poses.txt if it exists",
               false,
               "",
               "POSES.txt",
               cmd};
    std::vector<std::string> frames{"cam0", "vehicle"};
    TCLAP::ValuesConstraint<std::string> frameNames{frames};
    Text truthFrame{
        "", "ground-truth-frame", "Frame of the ground truth", false, "cam0", &frameNames, cmd};
    Text map{
        "",
        "map",
        "Localise the drive in a stored map: a map.delio or the result folder that contains it",
        false,
        "",
        "OLD",
        cmd};
    Text initialPose{"",
                     "initial-pose",
                     "Pose of the vehicle at the first scan in that map, accurate to a few metres "
                     "and degrees; only its surroundings are searched",
                     false,
                     "",
                     "X,Y,Z,YAW_DEG",
                     cmd};
    Switch extend{"", "extend", "Extend that map by this drive; OUTDIR/map.delio contains both",
                  cmd};
    Switch update{"", "update",
                  "Update that map: OUTDIR/map.delio keeps when its points were seen, seen through "
                  "and new",
                  cmd};
    Text saveRawlog{
        "",
        "save-rawlog",
        "Also copy the input rawlog, with the vehicle's motion (CActionRobotMovement3D) "
        "before each scan",
        false,
        "",
        "FILE",
        cmd};
    Switch keepDynamic{"", "keep-dynamic", "Also write the removed dynamic points: map_dynamic.ply",
                       cmd};
    Switch noImu{"", "no-imu", "Do not use the recording's IMU", cmd};
    Switch level{"", "level", "Turn the map so that z is up, by the accelerations of its IMU", cmd};
    Switch noOdometry{"", "no-odometry", "Do not use the recording's wheel odometry", cmd};
    Switch noMap{"", "no-map", "Do not build a map", cmd};
    Switch noGnss{"", "no-gnss", "Do not use GNSS fixes", cmd};
    Text gnss{"",
              "gnss",
              "GNSS fixes of the drive: .csv (time, latitude, longitude, height, ...) or NMEA; "
              "default: those in the recording, or gnss.csv or gnss.nmea beside a folder of scans",
              false,
              "",
              "FILE",
              cmd};
    Text antenna{
        "",    "antenna", "GNSS antenna in the vehicle frame, metres; overrides the recording",
        false, "",        "X,Y,Z",
        cmd};
    Switch noLoops{"", "no-loops", "Do not search for loop closures", cmd};
    Switch noGraph{"", "no-graph", "Skip pose-graph optimisation and loop closures", cmd};
    std::vector<std::string> formats{"tum", "json"};
    TCLAP::ValuesConstraint<std::string> formatNames{formats};
    Text poses{
        "",
        "poses",
        "Print each pose on stdout as it is found: TUM lines or JSON lines; the summary goes "
        "to stderr",
        false,
        "",
        &formatNames,
        cmd};
    Text publish{"",    "publish", "Send each pose as it is found: a JSON line per datagram",
                 false, "",        "udp://HOST:PORT",
                 cmd};
    Text record{"",    "record", "Live sensor: pcap for its packets; default: OUTDIR/packets.pcap",
                false, "",       "FILE",
                cmd};
    Switch noRecord{"", "no-record", "Live sensor: do not record its packets", cmd};
    TCLAP::ValueArg<double> idle{
        "",
        "idle",
        "Live sensor: end the drive after so long without a packet, seconds; 0: never",
        false,
        0,
        "SECONDS",
        cmd};
    Number queue{
        "",    "queue", "Live sensor: scans that may wait; where more come, some are dropped",
        false, {10},    "N",
        cmd};
    Switch gui{"", "gui", "Show progress in a window", cmd};
    Number serve{"",
                 "serve",
                 "Show progress in a browser on this machine, at http://127.0.0.1:PORT/; 0: any "
                 "free port",
                 false,
                 {},
                 "PORT",
                 cmd};
    Switch force{"", "force", "Overwrite existing files", cmd};
    Switch verbose{"", "verbose", "Print a line per scan, and full error texts", cmd};
};

/** The rest of its --help. */
cli::HelpText slamHelp();

/** From the weakest to the strongest: the profile, what the drive says of itself, -c, --set. Throws
 *  Error where one of them is not understood. */
Options optionsFor(SlamCommandLine& line, const std::optional<io::DriveMeta>& meta);

/** Every option with its meaning. What follows from the drive unless it is set is a comment: a file
 *  made of this leaves it to the drive. */
void printConfig(SlamCommandLine& line);

run::RunSettings settingsFor(SlamCommandLine& line, int argc, char** argv);

io::ScanSource sourceFor(SlamCommandLine& line, const std::string& input);

/** The only input is a live sensor. */
bool isLive(SlamCommandLine& line);

/** A pose graph, not a recording. */
bool isGraph(const std::string& input);

/** Why the command line contradicts itself; empty: it does not. */
std::string contradictionIn(SlamCommandLine& line);
}  // namespace delio
