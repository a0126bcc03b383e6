#include "delio/map/simplemap.h"

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "../io/gz_object.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"

namespace delio::map {
using mrpt::maps::CPointsMapXYZI;
using mrpt::maps::CSimpleMap;
using mrpt::poses::CPose3D;

void saveSimplemap(const CSimpleMap& map, const std::string& path) { io::saveWhole(map, path); }

CSimpleMap loadSimplemap(const std::string& path) {
    CSimpleMap map;
    io::loadWhole(path, "a .simplemap", map);
    for (std::size_t i = 0; i < map.size(); ++i)
        if (!map.getAsPair(i).pose || !map.getAsPair(i).sf)
            throw Error("'" + path + "' has a keyframe without a pose or without observations");
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
                    throw Error("the map's points are in another file, '" +
                                scan->getExternalStorageFile() + "': " + plainMessage(e));
                }
                if (scan->pointcloud)
                    all.insertAnotherMap(scan->pointcloud.get(), pose + scan->sensorPose);
                scan->unload();
            } else {
                mrpt::maps::CSimplePointsMap points;
                points.insertionOptions.minDistBetweenLaserPoints = 0;
                points.insertObservation(*observation, pose);
                all.insertAnotherMap(&points, CPose3D());
            }
        }
    }
    return all;
}
}  // namespace delio::map
