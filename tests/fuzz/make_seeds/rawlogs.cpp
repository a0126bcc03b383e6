#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "fast_spinner.h"
#include "seeds.h"
#include "spinner.h"

namespace delio::fuzz {
namespace {
mrpt::obs::CObservation3DRangeScan::Ptr depths() {
    auto observation = mrpt::obs::CObservation3DRangeScan::Create();
    observation->sensorLabel = "lidar";
    observation->timestamp = mrpt::Clock::fromDouble(1000);
    observation->hasRangeImage = true;
    observation->rangeImage_setSize(2, 2);
    observation->rangeImage.fill(1000);
    return observation;
}

mrpt::obs::CObservationRotatingScan rotating() {
    mrpt::obs::CObservationRotatingScan scan;
    scan.sensorLabel = "lidar";
    scan.timestamp = mrpt::Clock::fromDouble(1000);
    scan.rowCount = 2;
    scan.columnCount = 4;
    scan.rangeImage.setSize(2, 4);
    scan.rangeImage.fill(1000);
    scan.startAzimuth = -3;
    scan.azimuthSpan = 6;
    scan.sweepDuration = 0.1;
    return scan;
}

void rawlogs() {
    archive(seed("rawlog", "cloud"), *cloudObservation(), *cloudObservation());
    archive<mrpt::io::CFileGZOutputStream>(seed("rawlog", "gzip"), *cloudObservation());
    mrpt::obs::CSensoryFrame frame;
    frame.insert(cloudObservation());
    archive(seed("rawlog", "frame"), frame);
    archive(seed("rawlog", "depths"), *depths());
    archive(seed("rawlog", "rotating"), rotating());
    auto packets = fastSpinner().scan();
    packets.sensorLabel = "lidar";
    packets.timestamp = mrpt::Clock::fromDouble(1000);
    archive(seed("rawlog", "packets"), packets);
}

void externals() {
    writeText(seed("external", "kitti"), "0" + std::string(64, 'A'));
    const auto points = cloud();
    behind("1", seed("external", "mrpt"), [&](const fs::path& file) { archive(file, *points); });
    behind("1", seed("external", "gzip"),
           [&](const fs::path& file) { archive<mrpt::io::CFileGZOutputStream>(file, *points); });
    writeText(seed("external", "text"), "21 2 3\n4 5 6\n");
    behind("3", seed("external", "ranges.bin"), [](const fs::path& file) {
        depths()->rangeImage_convertToExternalStorage(file.filename().string(),
                                                      file.parent_path().string() + "/");
    });
    writeText(seed("external", "time"), "4" + std::string(16, '\0'));
    writeText(seed("external", "ring"), "5" + std::string(8, '\0'));
}

}  // namespace

void seedRawlogs() {
    rawlogs();
    externals();
}
}  // namespace delio::fuzz
