#pragma once
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/serialization/CArchive.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/recordings/rawlog_reader.h"
#include "test_data.h"

/** Rawlogs to be read in tests. */
namespace delio::rawlog_test {
using mrpt::obs::CObservationPointCloud;

inline const mrpt::poses::CPose3D kOnTheRoof(1, 0.5, 1.8, 0.3, 0.02, -0.01);

/** A cloud of `points` points that tell which scan they are of. */
inline CObservationPointCloud::Ptr cloudObservation(int scan, const std::string& label = "lidar",
                                                    std::size_t points = 50) {
    auto cloud = mrpt::maps::CPointsMapXYZI::Create();
    for (std::size_t i = 0; i < points; ++i)
        cloud->insertPoint(static_cast<float>(scan), static_cast<float>(i), -1.5F);
    auto observation = CObservationPointCloud::Create();
    observation->pointcloud = cloud;
    observation->sensorLabel = label;
    observation->sensorPose = kOnTheRoof;
    observation->timestamp = mrpt::Clock::fromDouble(1000 + 0.1 * scan);
    return observation;
}

template <typename Stream = mrpt::io::CFileOutputStream>
void writeRawlog(const std::string& path,
                 const std::vector<mrpt::serialization::CSerializable::Ptr>& objects) {
    Stream out(path);
    auto archive = mrpt::serialization::archiveFrom(out);
    for (const auto& object : objects) archive << *object;
}

inline std::string faultOf(io::ScanReader& reader, std::size_t& scans) {
    scans = 0;
    try {
        while (reader.next()) ++scans;
    } catch (const Error& e) {
        EXPECT_FALSE(reader.next()) << "a reader is at its end after an error";
        return e.what();
    }
    return "";
}

/** The meta.yaml that says what second 0 of the drive is. */
inline void writeEpoch(const std::string& rawlog, double epoch_s) {
    io::DriveMeta meta;
    meta.epoch_s = epoch_s;
    test::writeText(io::sidecarPath(rawlog, ".meta.yaml"), io::textOf(meta));
}

template <typename Value>
void writeValues(const std::filesystem::path& file, const std::vector<Value>& values) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(Value)));
}
}  // namespace delio::rawlog_test
