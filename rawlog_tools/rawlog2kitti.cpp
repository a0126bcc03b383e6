// rawlog2kitti: the LiDAR scans of a rawlog as a KITTI odometry sequence.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/rawlog_reader.h"
#include "delio/version.h"
#include "overlap.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

// Of a sequence; of a folder that is there already (--force) only these are replaced: it may hold
// more. velodyne/ marks it as whole: a folder without it is no sequence.
const std::vector<std::string> kNames = {"velodyne", "times.txt", "calib.txt", "poses.txt"};

/** Writes into the folder `partial` what will be `name` in `target`. */
void write(const io::PartialFolder& partial, const fs::path& target, const std::string& name,
           const void* bytes, std::size_t count) {
    std::ofstream out(partial.path() / name, std::ios::binary);
    out.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count));
    out.close();
    if (!out)
        throw Error("cannot write '" + (target / name).string() +
                    "': the disk is full, or the folder is gone or not writable");
}

struct Arguments {
    TCLAP::CmdLine cmd{"converts the LiDAR scans of a rawlog to a KITTI odometry sequence", ' ',
                       kVersion};
    TCLAP::ValueArg<std::string> input{"i", "input", "Rawlog to read", true, "", "IN.rawlog", cmd};
    TCLAP::ValueArg<std::string> output{"o", "output", "Folder to create", true, "", "SEQUENCE_DIR",
                                        cmd};
    TCLAP::ValueArg<std::string> label{
        "", "sensor-label", "Sensor to convert; default: the first one", false, "", "L", cmd};
    TCLAP::ValueArg<std::string> images{
        "", "images", "Folder with the external files", false, "", "DIR", cmd};
    TCLAP::SwitchArg force{"", "force", "Overwrite existing files", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "Print full error texts", cmd};
};

/** The folder to make, by all its names. */
fs::path targetOf(const std::string& output) {
    return fs::absolute(fs::path(output) / "").lexically_normal().parent_path();
}

/** Nothing that is read may be overwritten. */
void refuseItself(Arguments& args, const fs::path& target) {
    auto inputs = cli::filesOfRawlog(args.input.getValue());
    inputs.push_back(args.images.getValue());
    std::vector<std::string> outputs;
    outputs.reserve(std::size(kNames));
    for (const auto& name : kNames) outputs.push_back((target / name).string());
    cli::refuseOverlap(inputs, outputs);
}

/** A file beside the rawlog that travels as it is. */
struct SideFile {
    std::string name;  //!< in the sequence
    std::string path, text;
    std::optional<std::size_t> rows;  //!< none: they do not belong to scans
};

/** Existing side files. Throws Error for invalid ones. */
std::vector<SideFile> sideFilesOf(const std::string& rawlog) {
    std::vector<SideFile> files;
    for (const std::string name : {"times.txt", "calib.txt", "poses.txt"}) {
        SideFile file{name, io::sidecarPath(rawlog, "." + name), "", {}};
        if (!fs::exists(file.path)) continue;
        if (!fs::is_regular_file(file.path))
            throw Error("'" + file.path + "' is not a regular file");
        if (name == "calib.txt")
            io::readCalibration(file.path);
        else
            file.rows = name == "times.txt" ? io::readTimes(file.path).size()
                                            : io::readTrajectory(file.path).poses.size();
        std::ifstream in(file.path, std::ios::binary);
        file.text.assign(std::istreambuf_iterator<char>(in), {});
        files.push_back(file);
    }
    return files;
}

/** The sequence that a rawlog becomes. */
class Sequence {
 public:
    explicit Sequence(Arguments& args)
        : path_(targetOf(args.output.getValue())),
          reader_(args.input.getValue(), args.label.getValue(), args.images.getValue()),
          sideFiles_(sideFilesOf(args.input.getValue())),
          wasThere_(fs::exists(path_)),
          target_(path_) {
        if (wasThere_) cli::refuseExisting(path_.string(), args.force.getValue());
        partial_.emplace(path_, path_.string());
        std::error_code fault;
        fs::create_directory(partial_->path() / "velodyne", fault);
        if (fault) throw Error("cannot write '" + path_.string() + "': " + fault.message());
    }

    /** False if Ctrl-C came before the end. */
    bool writeScans() {
        cli::Progress progress("converting", 0);
        while (const auto scan = next()) {
            char text[64];
            std::snprintf(text, sizeof(text), "velodyne/%06zu.bin", scans_++);
            const auto xyzi = io::xyziOf(*scan->points);
            write(*partial_, path_, text, xyzi.data(), xyzi.size() * sizeof(float));
            std::snprintf(text, sizeof(text), "%.7f\n", scan->stamp_s);
            times_ += text;
            progress.update(scans_);
        }
        return !cli::interrupted();
    }

    void finish(const std::string& rawlog) {
        if (scans_ == 0) throw Error("'" + rawlog + "' contains no LiDAR scans");
        for (const auto& other : reader_.otherLabels())
            cli::warn("scans of the sensor '" + other +
                      "' are ignored; choose a sensor with --sensor-label");
        write(*partial_, path_, "times.txt", times_.data(), times_.size());
        for (const auto& file : sideFiles_) {
            if (file.rows && *file.rows != scans_)
                throw Error("'" + file.path + "' has " + std::to_string(*file.rows) + " rows for " +
                            std::to_string(scans_) +
                            " scans; complete or remove it (it is optional)");
            write(*partial_, path_, file.name, file.text.data(), file.text.size());
        }
        partial_->putInPlace(kNames);
        cli::inform("wrote " + std::to_string(scans_) + " scans to '" + path_.string() + "'");
    }

 private:
    /** Nothing at the end, and after Ctrl-C. */
    std::optional<Scan> next() {
        try {
            auto scan = reader_.next();
            if (!cli::interrupted()) return scan;
        } catch (const Error&) {
            if (!cli::interrupted()) throw;
        }
        return {};
    }

    fs::path path_;
    io::RawlogReader reader_;
    std::vector<SideFile> sideFiles_;
    bool wasThere_;
    io::TargetFolder target_;
    std::optional<io::PartialFolder> partial_;
    std::size_t scans_ = 0;
    std::string times_;
};

int convert(Arguments& args) {
    if (args.input.getValue() == "-") cli::endInputAtInterrupt();
    cli::catchInterrupts();
    refuseItself(args, targetOf(args.output.getValue()));
    Sequence sequence(args);
    if (!sequence.writeScans()) return cli::kExitInterrupted;
    sequence.finish(args.input.getValue());
    return cli::kExitSuccess;
}

cli::HelpText help() {
    cli::HelpText help;
    help.writes = {{"velodyne/NNNNNN.bin", "points of one scan, x y z intensity as float32"},
                   {"times.txt", "time of each scan, seconds"},
                   {"calib.txt, poses.txt", "copied from next to the rawlog where they exist"}};
    help.examples = {{{"rawlog2kitti -i 07.rawlog -o sequences/07", "A drive"},
                      {"rawlog2kitti -i two.rawlog -o sequences/08 --sensor-label rear",
                       "Convert one of two sensors"}}};
    help.interrupted = "no output is written";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments args;
    return cli::run(args.cmd, help(), argc, argv, args.verbose, [&] { return convert(args); });
}
