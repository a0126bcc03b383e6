#include "clean_folder.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "delio/core/error.h"
#include "delio/map/cloud_files.h"
#include "delio/map/map_builder.h"
#include "delio/odometry/scan.h"

namespace delio {
namespace {
namespace fs = std::filesystem;

constexpr double kPeriod_s = 0.1;  // the files have no times

mrpt::maps::CPointsMapXYZI::Ptr seenFrom(const Eigen::Isometry3d& sensor,
                                         const map::MapPoints& points) {
    const Eigen::Isometry3d toSensor = sensor.inverse();
    auto cloud = mrpt::maps::CPointsMapXYZI::Create();
    cloud->reserve(points.size());
    for (const auto& point : points) {
        const Eigen::Vector3f at = (toSensor * point.position.cast<double>()).cast<float>();
        cloud->insertPointRGB(at.x(), at.y(), at.z(), point.intensity, 0, 0);
    }
    return cloud;
}

map::MapOptions everyPoint() {
    constexpr double kFarthest_m = 1e6;
    map::MapOptions options;
    options.voxelSize_m = options.minRange_m = 0;
    options.maxRange_m = kFarthest_m;
    return options;
}
}  // namespace

std::vector<std::string> pcdFilesIn(const std::string& folder) {
    std::error_code error;
    std::vector<std::string> files;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error))
        if (entry->path().extension() == ".pcd") files.push_back(entry->path());
    if (error) throw Error("cannot read folder '" + folder + "': " + error.message());
    if (files.empty()) throw Error("no .pcd file in folder '" + folder + "'");
    std::sort(files.begin(), files.end());
    return files;
}

MapInput cleanedFolder(const std::string& folder) {
    map::MapBuilder builder(everyPoint());
    std::vector<Eigen::Isometry3d> poses;
    for (const auto& file : pcdFilesIn(folder)) {
        Eigen::Isometry3d sensor;
        const auto points = map::loadPcd(file, sensor);
        const auto time = std::chrono::duration_cast<mrpt::Clock::duration>(
            std::chrono::duration<double>(kPeriod_s * static_cast<double>(poses.size())));
        Scan scan;
        scan.points = seenFrom(sensor, points);
        builder.takeScale(scaleOf(scan));  // of the first one
        builder.add(poses.size(), sensor, *scan.points, scan.sensorPose,
                    mrpt::Clock::time_point() + time);
        poses.push_back(sensor);
    }
    const auto isFirst = [&](const Eigen::Isometry3d& pose) {
        return pose.matrix() == poses.front().matrix();
    };
    if (poses.size() > 1 && std::all_of(poses.begin(), poses.end(), isFirst))
        throw Error("all .pcd files of '" + folder +
                    "' have the same VIEWPOINT: --clean needs the pose of the sensor there");
    auto built = builder.build(poses);
    MapInput map;
    map.name = fs::path(folder).lexically_normal().filename();
    map.points = std::move(built.points);
    map.dynamic = std::move(built.dynamic);
    map.keyframes = std::move(built.keyPoses);
    map.ways.push_back(std::move(poses));
    return map;
}
}  // namespace delio
