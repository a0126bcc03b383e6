#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <array>

#include "scans.h"

using namespace delio::fuzz;

namespace {
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationPointCloud;
using Format = CObservationPointCloud::ExternalStorageFormat;

constexpr std::size_t kPoints = 4;

template <typename Observation>
void write(const Observation& observation, const std::string& name) {
    mrpt::io::CFileOutputStream out(fileOf("", name));
    mrpt::serialization::archiveFrom(out) << observation;
}

void writeCloud(Format format, const std::string& file, const std::string& name) {
    CObservationPointCloud observation;
    observation.sensorLabel = "lidar";
    observation.timestamp = mrpt::Clock::fromDouble(1000);
    observation.pointcloud = mrpt::maps::CPointsMapXYZI::Create();
    observation.setAsExternalStorage(file, format);
    write(observation, name);
}

void writeRanges() {
    CObservation3DRangeScan observation;
    observation.sensorLabel = "lidar";
    observation.timestamp = mrpt::Clock::fromDouble(1000);
    observation.hasRangeImage = true;
    observation.rangeImage_setSize(2, 2);
    observation.rangeImage_convertToExternalStorage("ranges.bin",
                                                    (folder() / "d_Images/").string());
    write(observation, "ranges.rawlog");
}
}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    writeCloud(Format::KittiBinFile, "cloud.bin", "kitti.rawlog");
    writeCloud(Format::MRPT_Serialization, "cloud.gz", "mrpt.rawlog");
    writeCloud(Format::PlainTextFile, "cloud.txt", "text.rawlog");
    writeCloud(Format::KittiBinFile, "extras.bin", "extras.rawlog");
    fs::create_directories(folder() / "d_Images");
    writeRanges();
    fileOf(std::string(16 * kPoints, '\0'), "d_Images/extras.bin");
    return 0;
}

/** The files beside a rawlog that hold its points, and their times and rings. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::array<std::array<const char*, 2>, 6> kFiles{{{"kitti", "cloud.bin"},
                                                                   {"mrpt", "cloud.gz"},
                                                                   {"text", "cloud.txt"},
                                                                   {"ranges", "ranges.bin"},
                                                                   {"extras", "extras.time"},
                                                                   {"extras", "extras.ring"}}};
    Input input(data, size);
    const auto& [rawlog, name] = kFiles[input.pick(kFiles.size())];
    const std::string file = fileOf(input.rest(), std::string("d_Images/") + name);
    const std::string images = (folder() / "d_Images").string();
    readScans({(folder() / rawlog).string() + ".rawlog", "", images, ""});
    fs::remove(file);
    return 0;
}
