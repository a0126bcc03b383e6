#pragma once
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>

#include "delio/core/geometry.h"
#include "rawlog_files.h"

namespace delio::test {
/** Pose of the right half's sensor in the vehicle; that of the left half is the identity. */
inline const mrpt::poses::CPose3D kRightSensor(0.4, -0.6, 0.2, 2, 0.1, -0.05);

/** Which scans a half has. */
using HasScan = std::function<bool(std::size_t scan)>;

/** Adds the half of `scan` with azimuths on one side of the x axis to `rawlog`, which lies beside
 *  its images. */
inline void writeHalf(const Scan& scan, bool left, const std::filesystem::path& images,
                      mrpt::serialization::CArchive& rawlog) {
    const auto pose = left ? Eigen::Isometry3d::Identity() : fromMrpt(kRightSensor);
    std::vector<float> xyzi, times;
    std::vector<std::uint16_t> rings;
    for (std::size_t i = 0; i < scan.points->size(); ++i) {
        Eigen::Vector3f point;
        scan.points->getPointFast(i, point.x(), point.y(), point.z());
        if ((point.y() > 0) != left) continue;
        const Eigen::Vector3f own = (pose.inverse() * point.cast<double>()).cast<float>();
        xyzi.insert(xyzi.end(), {own.x(), own.y(), own.z(), 0.5F});
        if (!scan.times_s.empty()) times.push_back(scan.times_s[i]);
        if (!scan.rings.empty()) rings.push_back(scan.rings[i]);
    }
    char name[32];
    std::snprintf(name, sizeof(name), "%s_%06zu", left ? "left" : "right", scan.index);
    rawlog_test::writeValues(images / (std::string(name) + ".bin"), xyzi);
    if (!times.empty()) rawlog_test::writeValues(images / (std::string(name) + ".time"), times);
    if (!rings.empty()) rawlog_test::writeValues(images / (std::string(name) + ".ring"), rings);
    mrpt::obs::CObservationPointCloud half;
    half.sensorLabel = left ? "left" : "right";
    half.sensorPose = toMrpt(pose);
    half.timestamp = scan.time;
    half.setAsExternalStorage(
        std::string(name) + ".bin",
        mrpt::obs::CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    rawlog << half;
}

/** The drive `whole` as a drive of two sensors, `left` and `right`, which see one half of each scan
 *  each. */
inline void splitDrive(
    const std::string& whole, const std::string& halves,
    const HasScan& leftHas = [](std::size_t) { return true; },
    const HasScan& rightHas = [](std::size_t) { return true; }) {
    namespace fs = std::filesystem;
    const fs::path images = io::sidecarPath(halves, "_Images");
    fs::create_directories(images);
    mrpt::io::CFileOutputStream out(halves);
    auto archive = mrpt::serialization::archiveFrom(out);
    io::RawlogReader reader(whole);
    while (const auto scan = reader.next()) {
        if (leftHas(scan->index)) writeHalf(*scan, true, images, archive);
        if (rightHas(scan->index)) writeHalf(*scan, false, images, archive);
    }
    for (const char* side : {".meta.yaml", ".times.txt", ".calib.txt", ".poses.txt"})
        fs::copy_file(io::sidecarPath(whole, side), io::sidecarPath(halves, side),
                      fs::copy_options::overwrite_existing);
}
}  // namespace delio::test
