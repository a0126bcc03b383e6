// delio-map: a map as another kind of file, a part of it, in another frame.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>

#include "clean_folder.h"
#include "cli.h"
#include "control_points.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/earth/georeference.h"
#include "delio/files/output.h"
#include "delio/map/frames.h"
#include "delio/map/map_point.h"
#include "delio/places/edit_graph.h"
#include "delio/places/stored_map.h"
#include "delio/run/run_folder.h"
#include "delio/version.h"
#include "map_input.h"
#include "map_outputs.h"
#include "overlap.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;
using Text = TCLAP::ValueArg<std::string>;
using Number = TCLAP::ValueArg<double>;
using Words = TCLAP::ValuesConstraint<std::string>;

std::optional<Eigen::AlignedBox3d> boxIn(const std::string& text) {
    const auto n = cli::numbersIn(text, 6);
    if (n.empty()) return {};
    const Eigen::AlignedBox3d box(Eigen::Vector3d(n.data()), Eigen::Vector3d(n.data() + 3));
    if (box.isEmpty()) return {};
    return box;
}

std::optional<map::GeoReference> placeIn(const std::string& text) {
    const auto n = cli::numbersIn(text, 4);
    if (n.empty()) return {};
    const map::GeoReference place{n[0], n[1], n[2], n[3]};
    if (std::abs(place.latitude_deg) > 90 || std::abs(place.longitude_deg) > 180 ||
        std::abs(place.altitude_m) > 1e6 || std::abs(place.heading_deg) > 360)
        return {};
    return place;
}

/** TCLAP constraint checked by a function. */
class Checked : public TCLAP::Constraint<std::string> {
 public:
    Checked(std::string shape, bool (*isGood)(const std::string&))
        : shape_(std::move(shape)), isGood_(isGood) {}
    std::string description() const override { return shape_; }
    std::string shortID() const override { return shape_; }
    bool check(const std::string& text) const override { return isGood_(text); }

 private:
    std::string shape_;
    bool (*isGood_)(const std::string&);
};

class Metres : public TCLAP::Constraint<double> {
 public:
    explicit Metres(double least) : least_(least) {}
    std::string description() const override { return shortID(); }
    std::string shortID() const override { return "M, " + digitsOf(least_) + " to 1000"; }
    bool check(const double& value) const override { return value >= least_ && value <= 1000; }

 private:
    double least_;
};

/** Command-line arguments. */
struct Arguments {
    Arguments();
    /** An option that would have no effect; empty: none. */
    std::string fault();
    std::string importFault();
    bool isStored();
    /** The graph of a stored map is listed or edited. */
    bool isGraph();
    std::string graphFault();
    /** The first of these that is set, as an error; empty: none is. */
    static std::string withoutEffect(std::initializer_list<TCLAP::Arg*> args,
                                     const std::string& why);
    MapOutputOptions options();

    TCLAP::CmdLine cmd;
    Checked boxes{"X0,Y0,Z0,X1,Y1,Z1", [](const std::string& text) { return bool(boxIn(text)); }};
    Checked places{"LAT,LON,ALT,HEADING",
                   [](const std::string& text) { return bool(placeIn(text)); }};
    Metres spacings{0}, lengths{1e-3};
    std::vector<std::string> valueNames = map::colourByNames();
    std::vector<std::string> colormapNames = map::colormapNames();
    std::vector<std::string> frameNames{"map", "ground", "enu", "utm"};
    Words values{valueNames}, colormaps{colormapNames}, frames{frameNames};

    Text input;
    Text clean{"",
               "clean",
               "Folder of scans (.pcd) that are in one frame, with the sensor's pose as VIEWPOINT: "
               "the map without the points that other scans saw through",
               false,
               "",
               "FOLDER",
               cmd};
    Text import;
    Text edits{
        "",
        "edits",
        "Edit the pose graph of a stored map: lines 'add A B' (an edge between two submaps, if "
        "registration confirms it) and 'forbid A B'; OUT is a .delio. With -o OUT.csv and "
        "without this option, the edges between submaps are listed",
        false,
        "",
        "EDITS.txt",
        cmd};
    Text at{"",
            "at",
            "Stored map as it was then: 2026-11-28T06:00:00Z, without the time of day, or Unix "
            "seconds",
            false,
            "",
            "TIME",
            cmd};
    Text output;
    Text crop{"",    "crop", "Keep the points in this box (metres, in the output frame)",
              false, "",     &boxes,
              cmd};
    Number maxHeight{"",
                     "max-height",
                     "Leave out points higher than this above the ground around them, metres: "
                     "rooms without their ceilings",
                     false,
                     0,
                     &lengths,
                     cmd};
    Number spacing;
    Text colourBy, colormap;
    Number resolution, height;
    Text frame, georeference;
    Text control{"",
                 "control",
                 "Known points: name, x, y, z (m, in the map), latitude, longitude or easting, "
                 "northing, zone, and height. Those with 1 in the column use place the map, the "
                 "others are checked",
                 false,
                 "",
                 "POINTS.csv",
                 cmd};
    TCLAP::SwitchArg force, verbose;
};

Arguments::Arguments()
    : cmd("converts, crops and georeferences maps", ' ', kVersion),
      input("i", "input", "Map: the result folder of a delio-slam run, or a file", false, "",
            "FOLDER|FILE.delio|FILE.ply|FILE.pcd|FILE.las|FILE.simplemap", cmd),
      import("", "import",
             "Point cloud of another program (metres, z up, any origin) to localise drives in; OUT "
             "is a .delio",
             false, "", "CLOUD.ply|.pcd|.las", cmd),
      output("o", "output",
             "File to write; a .yaml for ROS's map_server comes with a .pgm image; a .delio with "
             "--import and --edits; a .csv lists the edges of a stored map",
             true, "", "OUT.ply|.pcd|.las|.3Dscene|.html|.gridmap|.yaml", cmd),
      spacing(
          "", "spacing",
          "Minimum distance between points, metres; 0: keep all; of an imported cloud 0.05 to 2, "
          "default 0.3, of a small cloud 0.15",
          false, 0, &spacings, cmd),
      colourBy("", "color-by", "Value shown by the colours", false, "height", &values, cmd),
      colormap("", "colormap", "Colour map", false, "turbo", &colormaps, cmd),
      resolution("", "resolution", "Cell size of a grid, metres", false, 0.1, &lengths, cmd),
      height("", "height",
             "Height of the robot: points 0.3 m to this height above the ground are obstacles",
             false, 2, &lengths, cmd),
      frame("", "frame",
            "Output frame. map: unchanged; ground: levelled, z = 0 on the ground below the first "
            "pose; enu, utm: of a georeferenced map, east-north-up or UTM. A .las of a "
            "georeferenced map is in UTM unless you set this",
            false, "map", &frames, cmd),
      georeference("", "georeference",
                   "Write east-north-up coordinates, metres from the first pose; give its latitude "
                   "and longitude (deg), altitude (m above the WGS84 ellipsoid) and heading (of "
                   "the vehicle's x axis, deg clockwise from north)",
                   false, "", &places, cmd),
      force("", "force", "Overwrite existing files", cmd),
      verbose("", "verbose", "Print progress and full error texts", cmd) {}

std::string Arguments::fault() {
    if (input.isSet() + import.isSet() + clean.isSet() != 1)
        return "give either -i, --clean or --import";
    if (import.isSet()) return importFault();
    if (at.isSet() && !isStored())
        return "--at needs a stored map as input: a .delio or the folder of a run";
    if (at.isSet() && at.getValue().empty()) return "--at needs a time";
    if (isGraph()) return clean.isSet() ? "--clean writes no graph" : graphFault();
    if (georeference.isSet() && control.isSet()) return "give either --georeference or --control";
    if (georeference.isSet() && frame.isSet() && frame.getValue() != "utm")
        return "--georeference gives east-north-up or, with --frame utm, UTM: no other --frame";
    const MapOutput& kind = mapOutputFor(output.getValue());
    if (kind.isGrid && (colourBy.isSet() || colormap.isSet()))
        return "--color-by and --colormap have no effect on a grid";
    if (kind.isGrid && maxHeight.isSet())
        return "--max-height has no effect on a grid; its obstacles end at --height";
    if (!kind.isGrid && (resolution.isSet() || height.isSet()))
        return "--resolution and --height only apply to grids (.gridmap, .yaml)";
    if (kind.isGrid && !(height.getValue() > map::OccupancyOptions().low_m))
        return "--height must be more than " + digitsOf(map::OccupancyOptions().low_m) + " m";
    return "";
}

std::string Arguments::importFault() {
    if (fs::path(output.getValue()).extension() != ".delio")
        return "--import writes a stored map: give -o OUT.delio";
    auto none = withoutEffect({&edits, &at, &crop, &colourBy, &colormap, &resolution, &height,
                               &maxHeight, &frame, &georeference, &control},
                              "with --import");
    if (!none.empty()) return none;
    if (spacing.isSet() && !(spacing.getValue() >= 0.05 && spacing.getValue() <= 2))
        return "--spacing of an imported cloud must be 0.05 to 2 m";
    return "";
}

std::string Arguments::withoutEffect(std::initializer_list<TCLAP::Arg*> args,
                                     const std::string& why) {
    for (TCLAP::Arg* arg : args)
        if (arg->isSet()) return "--" + arg->getName() + " has no effect " + why;
    return "";
}

bool Arguments::isStored() {
    const fs::path path = input.getValue();
    return input.isSet() && (path.extension() == ".delio" || fs::is_directory(path));
}

bool Arguments::isGraph() {
    return edits.isSet() || fs::path(output.getValue()).extension() == ".csv";
}

std::string Arguments::graphFault() {
    if (fs::path(output.getValue()).extension() != (edits.isSet() ? ".delio" : ".csv"))
        return "--edits writes a stored map: give -o OUT.delio";
    return withoutEffect({&at, &crop, &spacing, &colourBy, &colormap, &resolution, &height,
                          &maxHeight, &frame, &georeference, &control},
                         "on the graph of a map");
}

MapOutputOptions Arguments::options() {
    MapOutputOptions options;
    options.colouring.by = map::colourByNamed(colourBy.getValue());
    options.colouring.colormap = map::colormapNamed(colormap.getValue());
    options.grid.resolution_m = resolution.getValue();
    options.grid.height_m = height.getValue();
    return options;
}

std::string frameFileOf(const std::string& output) { return output + ".frame.yaml"; }

/** All that may be written: OUT, which marks it as whole, and what is beside it. */
std::vector<std::string> outputsOf(const std::string& output) {
    auto files = filesOf(output);
    files.push_back(frameFileOf(output));
    files.push_back(controlFileOf(output));
    return files;
}

void refuseMissingFolder(const std::string& output) {
    const fs::path folder = fs::absolute(output).parent_path();
    if (!fs::is_directory(folder))
        throw Error("cannot write '" + output + "': no such folder: '" + folder.string() + "'");
}

/** Checks of the files before the map is read. */
void checkFiles(Arguments& asked) {
    const std::string output = asked.output.getValue();
    if (!asked.clean.isSet() && !asked.at.isSet()) mapFileIn(asked.input.getValue());
    auto inputs = asked.clean.isSet() ? pcdFilesIn(asked.clean.getValue())
                                      : mapFilesIn(asked.input.getValue());
    if (asked.at.isSet()) inputs.push_back(run::storedMapIn(asked.input.getValue()));
    if (asked.control.isSet()) inputs.push_back(asked.control.getValue());
    cli::refuseOverlap(inputs, outputsOf(output));
    for (const auto& file : outputsOf(output)) cli::refuseExisting(file, asked.force.getValue());
    refuseMissingFolder(output);
}

/** Where the map lies on the earth: as it says itself, or as --georeference says. */
std::optional<earth::Georeference> earthOf(const MapInput& map,
                                           const std::optional<map::GeoReference>& place) {
    if (!place) return map.earth;
    earth::Georeference known;
    known.origin = {place->latitude_deg, place->longitude_deg, place->altitude_m};
    known.enuFromMap = map::enuFrame(map.points, map.firstPose(), place->heading_deg);
    return known;
}

/** The frame to write the map in. */
std::string frameOf(Arguments& asked, bool isGeoreferenced) {
    const bool las = fs::path(asked.output.getValue()).extension() == ".las";
    std::string frame = asked.frame.getValue();
    if (!asked.frame.isSet() && isGeoreferenced && las) return "utm";
    if (!asked.frame.isSet() && asked.georeference.isSet()) return "enu";
    if ((frame == "enu" || frame == "utm") && !isGeoreferenced)
        throw Error("'" + asked.input.getValue() + "' is not georeferenced: --frame " + frame +
                    " needs --georeference, --control, or a map of a drive with GNSS fixes");
    return frame;
}

void move(MapInput& map, const Eigen::Isometry3d& outFromMap) {
    map::move(map.points, outFromMap);
    map::move(map.dynamic, outFromMap);
    for (auto& way : map.ways)
        for (auto& pose : way) pose = outFromMap * pose;
    for (auto& pose : map.keyframes) pose = outFromMap * pose;
    for (auto& pose : map.sensor.poses) pose = outFromMap * pose;
    if (map.earth) map.earth->enuFromMap = map.earth->enuFromMap * outFromMap.inverse();
}

/** Into UTM less an offset, which the file of the frame names. */
void moveToUtm(MapInput& map, const earth::MapToUtm& utm) {
    const auto movePose = [&](Eigen::Isometry3d& pose) {
        const Eigen::Vector3d position = utm(pose.translation());
        pose.linear() = utm.rotation() * pose.linear();
        pose.translation() = position;
    };
    for (auto* points : {&map.points, &map.dynamic})
        for (auto& point : *points) {
            point.position = utm(point.position.cast<double>()).cast<float>();
            point.normal = utm.rotation().cast<float>() * point.normal;
        }
    for (auto& way : map.ways)
        for (auto& pose : way) movePose(pose);
    for (auto& pose : map.keyframes) movePose(pose);
    for (auto& pose : map.sensor.poses) movePose(pose);
    if (map.earth) map.earth->enuFromMap.linear() *= utm.rotation().transpose();
    map.offset = utm.offset();
    map.wkt = earth::wktOf(utm.zone());
}

/** Writes a file beside the map, of which this is the path. */
using SaveBeside = std::function<void(const std::string& map)>;

/** Brings the map into the frame that was asked for. */
SaveBeside changeFrame(MapInput& map, Arguments& asked) {
    const auto place = placeIn(asked.georeference.getValue());
    const auto earth = earthOf(map, place);
    const std::string frame = frameOf(asked, earth.has_value());
    map.earth = earth;
    if (frame == "ground") {
        const Eigen::Isometry3d level = map::groundFrame(map.points, map.firstPose());
        move(map, level);
        return [=](const std::string& out) { map::saveFrame(level, {}, frameFileOf(out)); };
    }
    if (frame == "enu") {
        move(map, earth->enuFromMap);
        map::GeoReference origin = place.value_or(
            map::GeoReference{earth->origin.latitude_deg, earth->origin.longitude_deg,
                              earth->origin.height_m, earth::heading_deg(earth->enuFromMap)});
        return [=](const std::string& out) {
            map::saveFrame(earth->enuFromMap, origin, frameFileOf(out));
        };
    }
    if (frame == "utm") {
        moveToUtm(map, earth::MapToUtm(*earth));
        return [=](const std::string& out) { map::saveUtmFrame(*earth, frameFileOf(out)); };
    }
    if (map.offset.isZero() || fs::path(asked.output.getValue()).extension() == ".las") return {};
    return [offset = map.offset](const std::string& out) {
        map::saveFrame(Eigen::Isometry3d(Eigen::Translation3d(-offset)), {}, frameFileOf(out));
    };
}

/** All of the files or, where one cannot be written, none. */
void write(const MapInput& map, const std::string& path, const MapOutputOptions& options,
           std::initializer_list<SaveBeside> besides) {
    io::PartialFolder partial(io::folderOf(path), path);
    const std::string temporary = partial.path() / fs::path(path).filename();
    try {
        mapOutputFor(path).write(map, temporary, options);
        for (const auto& save : besides)
            if (save) save(temporary);
    } catch (const Error& e) {
        throw Error(partial.asInPlace(e.what()));
    }
    std::vector<std::string> names;
    for (const auto& file : outputsOf(path)) names.push_back(fs::path(file).filename());
    partial.putInPlace(names);
}

MapInput read(Arguments& asked) {
    if (asked.clean.isSet()) return cleanedFolder(asked.clean.getValue());
    if (!asked.at.isSet()) return readMap(asked.input.getValue(), 0);
    return readMap(run::storedMapIn(asked.input.getValue()), 0, asked.at.getValue());
}

void convert(Arguments& asked) {
    const auto say = [&](const std::string& text) {
        if (asked.verbose.getValue()) cli::inform(text);
    };
    const std::string output = asked.output.getValue();
    checkFiles(asked);
    const io::OutputLock lock(output);
    MapInput map = read(asked);
    say("read " + std::to_string(map.points.size()) + " points");
    if (asked.clean.isSet())
        say("removed " + std::to_string(map.dynamic.size()) + " dynamic points");

    SaveBeside saveErrors;
    if (asked.control.isSet()) {
        const auto points = placeByControl(asked.control.getValue(), map.earth);
        cli::inform(summaryOf(points, *map.earth));
        saveErrors = [points, place = *map.earth](const std::string& out) {
            io::writeControlErrors(points, place, controlFileOf(out));
        };
    }
    const auto saveFrame = changeFrame(map, asked);
    if (asked.maxHeight.isSet()) map::cutAbove(map.points, map.dynamic, asked.maxHeight.getValue());
    if (const auto box = boxIn(asked.crop.getValue())) {
        map::crop(map.points, *box);
        map::crop(map.dynamic, *box);
    }
    if (map.points.empty()) throw Error("no map point lies within --crop and --max-height");
    map::thinOut(map.points, asked.spacing.getValue());
    map::thinOut(map.dynamic, asked.spacing.getValue());
    write(map, output, asked.options(), {saveFrame, saveErrors});
    say("wrote " + std::to_string(map.points.size()) + " points as '" + output + "'");
}

/** Lists the edges between submaps, or changes them. */
void editGraph(Arguments& asked) {
    const std::string input = asked.input.getValue(), output = asked.output.getValue(),
                      edits = asked.edits.getValue();
    const std::string stored = run::storedMapIn(input);
    std::vector<std::string> inputs{stored};
    if (!edits.empty()) inputs.push_back(edits);
    cli::refuseOverlap(inputs, {output});
    cli::refuseExisting(output, asked.force.getValue());
    refuseMissingFolder(output);
    const io::OutputLock lock(output);
    const StoredMap map(stored);
    if (edits.empty())
        saveSubmapEdges(submapEdges(map), output);
    else
        StoredMap::save(edited(map, readGraphEdits(edits)), output);
}

void importMap(Arguments& asked) {
    const std::string cloud = asked.import.getValue(), output = asked.output.getValue();
    cli::refuseOverlap({cloud}, {output});
    cli::refuseExisting(output, asked.force.getValue());
    refuseMissingFolder(output);
    const io::OutputLock lock(output);
    const auto spacing =
        asked.spacing.isSet() ? std::optional(asked.spacing.getValue()) : std::nullopt;
    const auto made = importCloud(cloud, spacing, output);
    const auto& offset = made.origin.offset;
    if (made.outliers > 0)
        cli::inform("dropped " + std::to_string(made.outliers) +
                    " points that lie more than 50 km from the others");
    if (!offset.isZero())
        cli::inform("the map's coordinates are those of the cloud less " + fixed(offset.x(), 0) +
                    ", " + fixed(offset.y(), 0) + ", " + fixed(offset.z(), 0) + " m");
    if (asked.verbose.getValue())
        cli::inform("kept " + std::to_string(made.kept) + " of " + std::to_string(made.points) +
                    " points in " + std::to_string(made.submaps) + " submaps, " +
                    std::to_string(made.places) + " of them with free ground; tilt " +
                    fixed(made.tilt_deg, 1) + " deg");
}

cli::HelpText help() {
    cli::HelpText help;
    help.writes = {
        {"OUT",
         "the map as points (.ply, .pcd, .las), MRPT scene (.3Dscene), page for a browser (.html), "
         "MRPT "
         "grid (.gridmap) or ROS grid (.yaml and .pgm); of --import and --edits the "
         "map for delio-slam --map; the edges of its graph (.csv)"},
        {"OUT.frame.yaml",
         "with another frame than the map's: the transformation from the map's frame, or the "
         "offset and zone of UTM"},
        {"OUT.control.csv", "with --control: the error of each point, metres east, north and up"}};
    help.examples = {{{"delio-map -i 07-results -o 07.pcd --frame ground --spacing 0.5",
                       "Levelled and thinned to 0.5 m"},
                      {"delio-map --import site.las -o site.delio",
                       "Map for delio-slam --map of another program's cloud"}}};
    help.interrupted = "existing files are unchanged";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments asked;
    return cli::run(asked.cmd, help(), argc, argv, asked.verbose, [&] {
        const std::string fault = asked.fault();
        if (!fault.empty()) {
            cli::inform(fault + "; see --help");
            return cli::kExitBadCommandLine;
        }
        if (asked.import.isSet())
            importMap(asked);
        else
            asked.isGraph() ? editGraph(asked) : convert(asked);
        return cli::kExitSuccess;
    });
}
