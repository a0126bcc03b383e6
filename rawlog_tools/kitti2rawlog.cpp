// kitti2rawlog: a KITTI odometry sequence or raw drive as an MRPT rawlog.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "cli.h"
#include "delio/error.h"
#include "delio/io/rawlog_writer.h"
#include "delio/version.h"
#include "kitti_drive.h"

namespace {
using namespace delio;

std::vector<float> readScan(const std::filesystem::path& file) {
    const auto bytes = std::filesystem::file_size(file);
    if (bytes % (4 * sizeof(float)) != 0)
        throw Error("'" + file.string() + "' is cut off: its size (" + std::to_string(bytes) +
                    " bytes) is no multiple of 16");
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
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("kitti2rawlog: a KITTI odometry sequence or raw drive as an MRPT rawlog",
                       ' ', kVersion);
    TCLAP::ValueArg<std::string> input("i", "input", "Folder of the sequence or of the raw drive",
                                       true, "", "SEQUENCE_DIR", cmd);
    TCLAP::ValueArg<std::string> output("o", "output", "Rawlog to write", true, "", "OUT.rawlog",
                                        cmd);
    TCLAP::SwitchArg embed("", "embed", "Keep the points in the rawlog, not in OUT_Images/", cmd);
    TCLAP::ValueArg<cli::Count> start("", "start", "First scan to take, from 0", false, {}, "N",
                                      cmd);
    TCLAP::ValueArg<cli::Count> count("", "count", "How many scans to take; 0: all", false, {}, "N",
                                      cmd);
    TCLAP::ValueArg<std::string> label("", "label", "Sensor label in the rawlog", false, "velodyne",
                                       "LABEL", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite what exists", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "All the text of errors", cmd);

    return cli::run(cmd, argc, argv, verbose, [&] {
        cli::catchInterrupts();
        auto drive = openKittiDrive(input.getValue(), start.getValue(), count.getValue());
        for (const auto& warning : drive.warnings) cli::warn(warning);
        drive.meta.generator = std::string("kitti2rawlog (delio ") + kVersion + ")";
        io::RawlogWriter writer(output.getValue(), label.getValue(), embed.getValue(),
                                force.getValue());
        {
            cli::Progress progress("converting", drive.scans.size());
            for (std::size_t i = 0; i < drive.scans.size(); ++i) {
                if (cli::interrupted()) return cli::kExitInterrupted;
                writer.add(drive.times_s[i], drive.meta.epoch_s, readScan(drive.scans[i]));
                progress.update(i + 1);
            }
        }
        if (drive.timeRows.empty())
            for (const double time : drive.times_s) {
                char row[32];
                std::snprintf(row, sizeof(row), "%.9f", time);
                drive.timeRows.emplace_back(row);
            }
        writer.finish(drive.meta, joined(drive.timeRows), drive.calibText, joined(drive.poseRows));
        cli::inform("wrote " + std::to_string(writer.scans()) + " scans to '" + output.getValue() +
                    "'");
        return cli::kExitSuccess;
    });
}
