// kitti2rawlog: a KITTI odometry sequence or raw drive as an MRPT rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/kitti_drive.h"
#include "delio/version.h"
#include "overlap.h"

namespace {
using namespace delio;

/** Throws Error for a scan that is cut off. */
std::uintmax_t sizeOf(const std::filesystem::path& file) {
    const auto bytes = std::filesystem::file_size(file);
    if (bytes % (4 * sizeof(float)) != 0)
        throw Error("'" + file.string() + "' is cut off: its size (" + std::to_string(bytes) +
                    " bytes) is not a multiple of 16");
    return bytes;
}

std::vector<float> readScan(const std::filesystem::path& file) {
    const auto bytes = sizeOf(file);
    std::vector<float> xyzi(bytes / sizeof(float));
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(xyzi.data()), static_cast<std::streamsize>(bytes));
    if (!in) throw Error("cannot read '" + file.string() + "'");
    return xyzi;
}

std::string joined(const std::vector<std::string>& rows) {
    std::string text;
    for (const auto& row : rows) text += row + "\n";
    return text;
}
struct Arguments {
    TCLAP::CmdLine cmd{"converts a KITTI odometry sequence or raw drive to an MRPT rawlog", ' ',
                       kVersion};
    TCLAP::ValueArg<std::string> input{
        "i", "input", "Folder of the sequence or raw drive", true, "", "SEQUENCE_DIR", cmd};
    TCLAP::ValueArg<std::string> output{"o",          "output", "Rawlog to write", true, "",
                                        "OUT.rawlog", cmd};
    TCLAP::SwitchArg embed{"", "embed", "Store the points in the rawlog instead of OUT_Images/",
                           cmd};
    TCLAP::SwitchArg link{
        "", "link", "Make OUT_Images/ symbolic links to KITTI's files instead of copies", cmd};
    TCLAP::ValueArg<cli::Count> start{"",  "start", "First scan to use, counted from 0", false, {},
                                      "N", cmd};
    TCLAP::ValueArg<cli::Count> count{"", "count", "Number of scans; 0: all", false, {}, "N", cmd};
    TCLAP::ValueArg<std::string> label{
        "", "label", "Sensor label in the rawlog", false, "velodyne", "LABEL", cmd};
    TCLAP::SwitchArg force{"", "force", "Overwrite existing files", cmd};
    TCLAP::SwitchArg verbose{"", "verbose", "Print full error texts", cmd};
};

/** What came up to a stamp, in the order of the stamps. */
template <typename Value>
void addUpTo(double stamp_s, const std::vector<Value>& values, std::size_t& next, double epoch_s,
             io::RawlogWriter& writer) {
    for (; next < values.size() && values[next].stamp_s <= stamp_s; ++next)
        writer.add(values[next], epoch_s);
}

/** False if Ctrl-C came before the last scan. */
bool writeScans(const io::KittiDrive& drive, bool link, io::RawlogWriter& writer) {
    cli::Progress progress("converting", drive.scans.size());
    std::size_t imu = 0, fix = 0;
    const auto addOxts = [&](double stamp_s) {
        addUpTo(stamp_s, drive.imu, imu, drive.meta.epoch_s, writer);
        addUpTo(stamp_s, drive.fixes, fix, drive.meta.epoch_s, writer);
    };
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
        if (cli::interrupted()) return false;
        const auto& file = drive.scans[i];
        addOxts(drive.times_s[i]);
        if (link) {
            sizeOf(file);
            writer.addLinked(drive.times_s[i], drive.meta.epoch_s, file.string());
        } else {
            writer.add(drive.times_s[i], drive.meta.epoch_s, readScan(file));
        }
        progress.update(i + 1);
    }
    addOxts(std::numeric_limits<double>::infinity());
    return true;
}

std::vector<std::string> timeRowsOf(const io::KittiDrive& drive) {
    if (!drive.timeRows.empty()) return drive.timeRows;
    std::vector<std::string> rows;
    for (const double time : drive.times_s) {
        char row[32];
        std::snprintf(row, sizeof(row), "%.9f", time);
        rows.emplace_back(row);
    }
    return rows;
}

std::vector<std::string> inputsOf(const std::string& folder, const io::KittiDrive& drive) {
    std::vector<std::string> inputs = {folder, drive.posesName, drive.calibName};
    inputs.insert(inputs.end(), drive.scans.begin(), drive.scans.end());
    return inputs;
}

int convert(Arguments& args) {
    cli::catchInterrupts();
    if (args.link.getValue() && args.embed.getValue()) {
        cli::inform("--link and --embed exclude each other");
        return cli::kExitBadCommandLine;
    }
    auto drive =
        io::openKittiDrive(args.input.getValue(), args.start.getValue(), args.count.getValue());
    for (const auto& warning : drive.warnings) cli::warn(warning);
    drive.meta.generator = std::string("kitti2rawlog (delio ") + kVersion + ")";
    const std::string& output = args.output.getValue();
    cli::refuseOverlap(inputsOf(args.input.getValue(), drive), io::RawlogWriter::outputsOf(output));
    io::RawlogWriter writer(output, args.label.getValue(), args.embed.getValue(),
                            args.force.getValue());
    if (!writeScans(drive, args.link.getValue(), writer)) return cli::kExitInterrupted;
    writer.finish(drive.meta, joined(timeRowsOf(drive)), drive.calibText, joined(drive.poseRows));
    cli::inform("wrote " + std::to_string(writer.scans()) + " scans to '" + output + "'");
    return cli::kExitSuccess;
}

cli::HelpText help() {
    cli::HelpText help;
    help.writes = {
        {"OUT.rawlog",
         "one CObservationPointCloud per scan; of a raw drive with oxts/ also its fixes "
         "(CObservationGPS) and rates (CObservationIMU)"},
        {"OUT_Images/",
         "their points, x y z intensity as float32 (not with --embed); start RawLogViewer in the "
         "rawlog's folder to see them"},
        {"OUT.times.txt, OUT.calib.txt, OUT.poses.txt", "copied from KITTI where they exist"},
        {"OUT.meta.yaml", "sensor model and processing of the points"}};
    help.examples = {{{"kitti2rawlog -i dataset/sequences/07 -o 07.rawlog --link",
                       "Convert a sequence without copying its points"},
                      {"kitti2rawlog -i 2011_09_26_drive_0005_sync -o 5.rawlog --count 60",
                       "Convert the first 60 scans of a raw drive"}}};
    help.interrupted = "no output is written";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    Arguments args;
    return cli::run(args.cmd, help(), argc, argv, args.verbose, [&] { return convert(args); });
}
