#include "kitti_reader.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <cstring>

#include "../drive_clock.h"
#include "bin_scan.h"
#include "delio/core/error.h"
#include "file_bytes.h"
#include "folder_reader.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
/** KITTI's format: float x, y, z and intensity of each point. */
mrpt::maps::CPointsMap::Ptr readPoints(const fs::path& file) {
    const auto bytes = bytesOfFile(file);
    constexpr std::size_t kPoint = 4 * sizeof(float);
    refuseOtherLayout(file, bytes);
    if (bytes.size() % kPoint != 0)
        throw Error("'" + file.string() + "' is cut off: its size (" +
                    std::to_string(bytes.size()) + " bytes) is no multiple of 16");
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(bytes.size() / kPoint);
    for (std::size_t i = 0; i < points->size(); ++i) {
        float p[4];
        std::memcpy(p, bytes.data() + i * kPoint, kPoint);
        points->setPointFast(i, p[0], p[1], p[2]);
        points->setPointIntensity(i, p[3]);
    }
    points->mark_as_modified();
    return points;
}
}  // namespace

KittiReader::KittiReader(const fs::path& folder)
    : FilesReader("velodyne"),
      drive_(openKittiDrive(kittiFolderOf(folder), 0, 0)),
      meta_(drive_.meta) {}

Recording KittiReader::recording() const {
    Recording recording;
    recording.kind = meta_->source == "kitti-raw" ? "KITTI raw" : "KITTI odometry";
    if (drive_.nominalTimes) recording.kind += ", nominal times";
    if (meta_->sensorModel != "unknown") recording.sensor = meta_->sensorModel;
    recording.motionCompensated = meta_->motionCompensated;
    // KITTI's own scans are known to be, those of another sensor in its format are not.
    recording.compensationAssumed = meta_->motionCompensated && recording.sensor.empty();
    recording.scans = drive_.scans.size();
    recording.warnings = drive_.warnings;
    return recording;
}

SideFile KittiReader::truth() const {
    SideFile truth{drive_.posesName, ""};
    for (const auto& row : drive_.poseRows) truth.text += row + "\n";
    return truth;
}

Scan KittiReader::read(std::size_t index) {
    Scan scan;
    scan.points = readPoints(drive_.scans[index]);
    scan.time = timeOf(drive_.times_s[index], meta_->epoch_s);
    scan.stamp_s = secondsSince(meta_->epoch_s, scan.time);
    return scan;
}

bool isKittiFolder(const fs::path& folder) {
    const fs::path drive = kittiFolderOf(folder);
    return fs::is_directory(drive / "velodyne") ||
           fs::is_directory(drive / "velodyne_points" / "data");
}

std::unique_ptr<ScanReader> openKittiFolder(const ScanSource& source) {
    return std::make_unique<KittiReader>(source.path);
}
}  // namespace delio::io
