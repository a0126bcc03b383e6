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
/** What delio-slam is asked for. */
struct SlamCommandLine {
    using Text = TCLAP::ValueArg<std::string>;
    using Number = TCLAP::ValueArg<cli::Count>;
    using Switch = TCLAP::SwitchArg;

    /** `runs`: input and output are needed. */
    explicit SlamCommandLine(bool runs)
        : input(
              "i", "input",
              "Recording to read: rawlog, KITTI folder, folder of clouds, ROS bag, mcap, pcap, or "
              "\"-\" for a rawlog or pcap from a pipe; or a posegraph.g2o to optimise again. "
              "Several drives are joined where they meet",
              runs, "IN", cmd),
          output("o", "output", "Folder for the results", runs, "", "OUTDIR", cmd) {}

    TCLAP::CmdLine cmd{"LiDAR odometry, pose graph and map of a recording", ' ', kVersion};
    TCLAP::MultiArg<std::string> input;
    Text output;
    Text profile{"",    "profile",  "What all options are that are not set",
                 false, "accurate", cli::profileChoice(),
                 cmd};
    Text config{"c",          "config", "Options that differ from the profile's", false, "",
                "CONFIG.ini", cmd};
    TCLAP::MultiArg<std::string> set{
        "",
        "set",
        "One option of a section below; --print-config prints all of them",
        false,
        "section.key=value",
        cmd};
    Switch printConfig{
        "", "print-config",
        "Print all options with their meanings, and end; takes neither --input nor --output", cmd};
    Number start{"", "start", "First scan, from 0", false, {}, "N", cmd};
    Number count{"", "count", "How many scans to use at most; 0: all", false, {}, "N", cmd};
    Number every{"", "every", "Use every N-th scan only", false, {1}, "N", cmd};
    Text label{"",
               "sensor-label",
               "Sensor to use: a rawlog's label, a bag's topic, a pcap's port; default: that of "
               "the first scan, in bags the only one",
               false,
               "",
               "L",
               cmd};
    Text sensorInfo{"",
                    "sensor-info",
                    "Description of the sensor, for packets: an Ouster's json, a Velodyne's "
                    "calibration; default: the json beside the recording, or the usual one",
                    false,
                    "",
                    "FILE",
                    cmd};
    Text images{"", "images", "Folder of the rawlog's external files", false, "", "DIR", cmd};
    Number threads{"", "threads", "Threads to use; 0: all", false, {}, "N", cmd};
    Text truth{"",
               "ground-truth",
               "True poses; default: IN.poses.txt if it is there",
               false,
               "",
               "POSES.txt",
               cmd};
    std::vector<std::string> frames{"cam0", "vehicle"};
    TCLAP::ValuesConstraint<std::string> frameNames{frames};
    Text truthFrame{"", "ground-truth-frame", "Frame of the true poses", false, "cam0", &frameNames,
                    cmd};
    Text map{"",
             "map",
             "Localise the drive in a stored map: map.delio, or the folder of the run that made it",
             false,
             "",
             "OLD",
             cmd};
    Text initialPose{"",
                     "initial-pose",
                     "Where the vehicle is at the first scan in that map, to some metres and "
                     "degrees: looked for there only",
                     false,
                     "",
                     "X,Y,Z,YAW_DEG",
                     cmd};
    Switch extend{"", "extend", "Add what is new to that map: OUTDIR/map.delio is both", cmd};
    Switch keepDynamic{"", "keep-dynamic",
                       "Write what was taken out of the map as moving, too: map_dynamic.ply", cmd};
    Switch noMap{"", "no-map", "Leave out map, scene and map.png", cmd};
    Switch noLoops{"", "no-loops", "Do not search for places that the drive comes back to", cmd};
    Switch noGraph{"", "no-graph", "Leave out the pose graph's optimisation, and loops", cmd};
    Switch gui{"", "gui", "Show the drive in a window while it is processed", cmd};
    Switch force{"", "force", "Overwrite what exists", cmd};
    Switch verbose{"", "verbose", "A line for each scan, and all the text of errors", cmd};
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

/** A pose graph, not a recording. */
bool isGraph(const std::string& input);

/** Why the command line contradicts itself; empty: it does not. */
std::string contradictionIn(SlamCommandLine& line);
}  // namespace delio
