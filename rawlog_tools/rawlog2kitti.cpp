// rawlog2kitti: the LiDAR scans of a rawlog as a KITTI odometry sequence.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/io/drive_meta.h"
#include "delio/io/output_file.h"
#include "delio/io/rawlog_reader.h"
#include "delio/io/rawlog_writer.h"
#include "delio/version.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

void writeScan(const mrpt::maps::CPointsMap& points, const fs::path& file) {
    const auto xyzi = io::xyziOf(points);
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(xyzi.data()),
              static_cast<std::streamsize>(xyzi.size() * sizeof(float)));
    if (!out.flush()) throw Error("cannot write '" + file.string() + "': is the disk full?");
}

// Of a sequence; only these are touched.
const char* const kNames[] = {"velodyne", "times.txt", "calib.txt", "poses.txt"};

/** Of a folder that is there already (--force) all else stays: it may hold more than a sequence. */
void putInPlace(const fs::path& partial, const fs::path& target) {
    std::error_code fault;
    fs::create_directory(target, fault);
    for (const char* name : kNames) {
        if (!fault) fs::remove_all(target / name, fault);
        if (!fault && fs::exists(partial / name)) fs::rename(partial / name, target / name, fault);
    }
    if (fault) throw Error("cannot write '" + target.string() + "': " + fault.message());
}

/** Removes the half-written sequence unless it was given its name. */
struct PartialFolder {
    fs::path path;
    ~PartialFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};
struct Arguments {
    TCLAP::CmdLine cmd{"rawlog2kitti: the LiDAR scans of a rawlog as a KITTI odometry sequence",
                       ' ', kVersion};
    TCLAP::ValueArg<std::string> input{"i", "input", "Rawlog to read", true, "", "IN.rawlog", cmd};
    TCLAP::ValueArg<std::string> output{"o", "output", "Folder to make", true, "", "SEQUENCE_DIR",
                                        cmd};
    TCLAP::ValueArg<std::string> label{
        "", "sensor-label", "Sensor to take; default: the first one", false, "", "L", cmd};
    TCLAP::ValueArg<std::string> images{"",    "images", "Folder of the external files", false, "",
                                        "DIR", cmd};
    TCLAP::SwitchArg force{"", "force", "Overwrite what exists", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "All the text of errors", cmd};
};

/** The folder to make; throws Error where it cannot be made. */
fs::path targetOf(Arguments& args) {
    const fs::path target =
        fs::absolute(fs::path(args.output.getValue()) / "").lexically_normal().parent_path();
    cli::refuseExisting(target.string(), args.force.getValue());
    if (fs::exists(target) && !fs::is_directory(target))
        throw Error("'" + target.string() + "' exists and is no folder; choose another name");
    return target;
}

/** Fills velodyne/ of `folder`; the rows of times.txt, or nothing if Ctrl-C came before the end. */
std::optional<std::vector<std::string>> writeScans(io::RawlogReader& reader,
                                                   const fs::path& folder) {
    std::vector<std::string> times;
    cli::Progress progress("converting", 0);
    while (const auto scan = reader.next()) {
        if (cli::interrupted()) return {};
        char text[64];
        std::snprintf(text, sizeof(text), "%06zu.bin", times.size());
        writeScan(*scan->points, folder / "velodyne" / text);
        std::snprintf(text, sizeof(text), "%.7f\n", scan->stamp_s);
        times.emplace_back(text);
        progress.update(times.size());
    }
    return times;
}

void copySideFiles(const std::string& rawlog, const fs::path& folder) {
    for (const std::string name : kNames) {
        const fs::path side = io::sidecarPath(rawlog, "." + name);
        if (fs::is_regular_file(side))
            fs::copy_file(side, folder / name, fs::copy_options::overwrite_existing);
    }
}

int convert(Arguments& args) {
    cli::catchInterrupts();
    const fs::path target = targetOf(args);
    const std::string& rawlog = args.input.getValue();
    io::RawlogReader reader(rawlog, args.label.getValue(), args.images.getValue());

    const PartialFolder partial{target.parent_path() / (".partial-" + target.filename().string())};
    std::error_code fault;
    fs::create_directories(partial.path / "velodyne", fault);
    if (fault) throw Error("cannot write '" + target.string() + "': " + fault.message());

    const auto times = writeScans(reader, partial.path);
    if (!times) return cli::kExitInterrupted;
    if (times->empty()) throw Error("'" + rawlog + "' holds no LiDAR scans");
    for (const auto& other : reader.otherLabels())
        cli::warn("scans of sensor '" + other + "' were left out; see --sensor-label");
    io::replaceTextFile((partial.path / "times.txt").string(), [&](std::ostream& out) {
        for (const auto& time : *times) out << time;
    });
    copySideFiles(rawlog, partial.path);
    putInPlace(partial.path, target);
    cli::inform("wrote " + std::to_string(times->size()) + " scans to '" + target.string() + "'");
    return cli::kExitSuccess;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments args;
    return cli::run(args.cmd, argc, argv, args.verbose, [&] { return convert(args); });
}
