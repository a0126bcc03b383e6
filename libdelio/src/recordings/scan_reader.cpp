#include "delio/recordings/scan_reader.h"

#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/recordings/rawlog_reader.h"
#include "files/input_file.h"
#include "files/names.h"
#include "open_merged.h"
#include "recognised_reader.h"
#include "sources.h"
#include "turn_assembler.h"
#include "vehicle_box.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
std::unique_ptr<ScanReader> openFolder(const ScanSource& source) {
    if (isKittiFolder(source.path)) return openKittiFolder(source);
    if (fs::exists(fs::path(source.path) / "metadata.yaml")) return openRos2Folder(source);
    return openCloudFolder(source);
}

std::unique_ptr<ScanReader> openFile(const ScanSource& source, FileKind kind) {
    switch (kind) {
        case FileKind::kPcap:
            return openPcap(source);
        case FileKind::kRos1Bag:
            return openRos1Bag(source);
        case FileKind::kRos2Database:
            return openRos2Database(source);
        case FileKind::kMcap:
            return openMcap(source);
        case FileKind::kOsf:
            return openOsf(source);
        case FileKind::kRawlog:
            break;
    }
    return std::make_unique<RawlogReader>(source.path, source.label, source.imagesFolder);
}

std::unique_ptr<ScanReader> openSensor(const ScanSource& source) {
    if (isLive(source.path)) return openLive(source);
    const bool isPipe = source.path == "-", isFolder = fs::is_directory(source.path);
    if (!isPipe && !fs::exists(source.path))
        throw Error("cannot read '" + source.path + "': no such file or folder");
    if (!isPipe && !isFolder && !fs::is_regular_file(source.path))
        throw Error("'" + source.path +
                    "' is neither a file nor a folder; read a pipe from standard input with -i -");
    const auto recognised = [](std::unique_ptr<ScanReader> scans, Delivery delivery) {
        return std::make_unique<RecognisedReader>(std::move(scans), delivery);
    };
    const auto turns = [](std::unique_ptr<ScanReader> parts) {
        return std::make_unique<TurnAssembler>(std::move(parts));
    };
    if (isFolder) return recognised(turns(openFolder(source)), Delivery::kFile);
    const FileKind kind = kindOf(source.path);
    auto scans = openFile(source, kind);
    if (kind == FileKind::kPcap) return recognised(std::move(scans), Delivery::kPackets);
    // What comes through a pipe may be measured now.
    return recognised(turns(std::move(scans)), isPipe ? Delivery::kPipe : Delivery::kFile);
}
}  // namespace

std::string warningOfOther(const std::string& label) {
    return "scans of the sensor '" + label +
           "' are ignored; choose a sensor with --sensor-label, or merge them with --sensor-label "
           "all";
}

std::unique_ptr<ScanReader> openScans(const ScanSource& source) {
    const auto labels = labelsOf(source, openSensor);
    // A sector is seen from its own sensor, which the points of merged scans no longer say.
    const OpenSensor open = [&](const ScanSource& one) {
        return without(sectorsOf(source.vehicle, labels.size() > 1 ? one.label : ""),
                       openSensor(one));
    };
    std::unique_ptr<ScanReader> scans;
    if (labels.size() > 1 || !source.extrinsicsFile.empty() || !source.extrinsics.empty()) {
        scans = openMerged(source, labels, open);
    } else {
        ScanSource one = source;
        one.label = labels.front();
        scans = open(one);
    }
    return without(boxesOf(source.vehicle), std::move(scans));
}

std::unique_ptr<ScanReader> openScans(const std::string& path, const std::string& label,
                                      const std::string& imagesFolder) {
    return openScans({path, label, imagesFolder, ""});
}

std::string nameOfDrive(const std::string& path) {
    if (path == "-") return "stdin";
    if (isLive(path)) return "live";
    const fs::path whole = fs::absolute(fs::path(path) / "").lexically_normal().parent_path();
    const std::string name =
        printable(fs::is_directory(whole) ? whole.filename().string() : whole.stem().string());
    if (!isFileName(name))
        throw Error("a drive cannot have the name '" + name + "' (from '" + path +
                    "'): rename the recording");
    return name;
}

namespace {
constexpr std::size_t kBytes = 16;

std::string beginOf(const std::string& path) {
    if (path == "-") return beginOfInput(STDIN_FILENO);
    std::ifstream in(path, std::ios::binary);
    std::string bytes(kBytes, '\0');
    in.read(bytes.data(), kBytes);
    bytes.resize(static_cast<std::size_t>(in.gcount()));
    if (bytes.empty() && (!in.is_open() || !in.eof()))
        throw Error("cannot read '" + path + "': no such file, or not readable");
    if (bytes.empty()) throw Error("'" + path + "' is empty");
    return bytes;
}

bool begins(const std::string& bytes, std::string_view with) {
    return std::string_view(bytes).substr(0, with.size()) == with;
}

bool isPcap(const std::string& bytes) {
    using namespace std::string_view_literals;
    for (const auto magic : {"\xd4\xc3\xb2\xa1"sv, "\xa1\xb2\xc3\xd4"sv, "\x4d\x3c\xb2\xa1"sv,
                             "\xa1\xb2\x3c\x4d"sv, "\x0a\x0d\x0d\x0a"sv})
        if (begins(bytes, magic)) return true;
    return false;
}
}  // namespace

FileKind kindOf(const std::string& path) {
    const std::string bytes = beginOf(path);
    if (isPcap(bytes)) return FileKind::kPcap;
    if (begins(bytes, "#ROSBAG V2.0")) return FileKind::kRos1Bag;
    if (begins(bytes, "SQLite format 3")) return FileKind::kRos2Database;
    if (begins(bytes, "\x89MCAP")) return FileKind::kMcap;
    if (bytes.size() == kBytes && begins(bytes.substr(8), "OSF$")) {
        if (path != "-") return FileKind::kOsf;
        throw Error(
            "an .osf cannot be read from standard input, as its end describes it; give the "
            "file (-i FILE.osf)");
    }
    const std::string extension = fs::path(path).extension().string();
    for (const char* cloud : {".pcd", ".ply", ".las", ".bin", ".txt", ".csv"})
        if (extension == cloud)
            throw Error("'" + path + "' is a single scan; give the folder that contains all scans");
    if (begins(bytes, "#ROSBAG"))
        throw Error("'" + path +
                    "' is a ROS bag of a version other than 2.0; convert it with rosbag fix");
    if (extension == ".osf") throw Error("'" + path + "' is not an OSF file: its begin is damaged");
    for (const char* other : {".zstd", ".laz"})
        if (extension == other)
            throw Error("'" + path + "': " + other +
                        " files are not supported; inputs.md in DeLiO's documentation lists the "
                        "supported formats");
    return FileKind::kRawlog;
}

std::string describe(const Recording& recording) {
    std::string text = recording.sensor.empty() ? "unknown LiDAR" : recording.sensor;
    if (recording.rate_hz) text += ", " + rounded(*recording.rate_hz, 3) + " Hz";
    if (recording.startsEmpty)
        text += ", first scans empty";
    else
        text += recording.pointTimes ? ", points with times" : ", points without times";
    const std::string how = recording.compensationMeasured  ? " (measured)"
                            : recording.compensationAssumed ? " (assumed)"
                                                            : "";
    if (recording.motionCompensated)
        text += (*recording.motionCompensated ? ", de-skewed by the recorder"
                                              : ", not de-skewed by the recorder") +
                how;
    if (!recording.imu.empty()) text += ", IMU " + recording.imu;
    if (!recording.odometry.empty()) text += ", odometry " + recording.odometry;
    if (recording.scans) text += ", " + std::to_string(*recording.scans) + " scans";
    return text + " (" + recording.kind + ")";
}
}  // namespace delio::io
