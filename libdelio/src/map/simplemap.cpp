#include "delio/map/simplemap.h"

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <filesystem>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "mrpt/external_files.h"
#include "mrpt/object_file.h"

namespace delio::map {
using mrpt::maps::CPointsMapXYZI;
using mrpt::maps::CSimpleMap;
using mrpt::poses::CPose3D;

void saveSimplemap(const CSimpleMap& map, const std::string& path) { io::saveWhole(map, path); }

namespace {
/** From beside the file, where they are not in it. */
void loadPoints(mrpt::obs::CObservation& observation, std::size_t keyframe,
                const std::string& path) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::path(path).parent_path();
    const std::string images = (folder / fs::path(path).stem()).string() + "_Images";
    try {
        io::loadExternal(observation, {images, (folder / "Images").string()});
    } catch (const std::exception& e) {
        throw Error("keyframe " + std::to_string(keyframe) + " of '" + path +
                    "': " + plainMessage(e));
    }
}

/** Points of a scan that is not a cloud, such as a depth camera's or a 2D one. */
mrpt::maps::CSimplePointsMap pointsOf(const mrpt::obs::CObservation& observation,
                                      const CPose3D& pose) {
    mrpt::maps::CSimplePointsMap points;
    points.insertionOptions.minDistBetweenLaserPoints = 0;
    try {
        points.insertObservation(observation, pose);
    } catch (const std::exception&) {
        throw Error("an observation of the simplemap, '" + observation.sensorLabel + "' (" +
                    observation.GetRuntimeClass()->className + ") is invalid");
    }
    return points;
}
}  // namespace

CSimpleMap loadSimplemap(const std::string& path) {
    CSimpleMap map;
    io::loadWhole(path, "a .simplemap", io::FileOf::Keyframes, map);
    for (std::size_t i = 0; i < map.size(); ++i) {
        const auto keyframe = map.getAsPair(i);
        if (!keyframe.pose || !keyframe.sf)
            throw Error("'" + path + "' has a keyframe without a pose or without observations");
        for (const auto& observation : *keyframe.sf) {
            if (!observation)
                throw Error("'" + path + "' has a keyframe with an unsupported observation");
            loadPoints(*observation, i, path);
        }
    }
    return map;
}

std::vector<Eigen::Isometry3d> posesOf(const CSimpleMap& map) {
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t i = 0; i < map.size(); ++i)
        poses.push_back(fromMrpt(map.getAsPair(i).pose->getMeanVal()));
    return poses;
}

CPointsMapXYZI pointsOf(const CSimpleMap& map) {
    CPointsMapXYZI all;
    for (std::size_t i = 0; i < map.size(); ++i) {
        const CPose3D pose = map.getAsPair(i).pose->getMeanVal();
        for (const auto& observation : *map.getAsPair(i).sf) {
            const auto* scan =
                dynamic_cast<const mrpt::obs::CObservationPointCloud*>(observation.get());
            if (scan) {
                try {
                    scan->load();
                } catch (const std::exception& e) {
                    throw Error("the map's points are in the file '" +
                                scan->getExternalStorageFile() + "': " + plainMessage(e));
                }
                if (scan->pointcloud)
                    all.insertAnotherMap(scan->pointcloud.get(), pose + scan->sensorPose);
                scan->unload();
            } else {
                const auto points = pointsOf(*observation, pose);
                all.insertAnotherMap(&points, CPose3D());
            }
        }
    }
    return all;
}
}  // namespace delio::map
