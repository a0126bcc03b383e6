#include "delio/map/simplemap.h"

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "delio/error.h"
#include "gz_object.h"

namespace delio::map {
using mrpt::maps::CPointsMapXYZI;
using mrpt::maps::CSimpleMap;
using mrpt::poses::CPose3D;

void saveSimplemap(const CSimpleMap& map, const std::string& path) { saveWhole(map, path); }

CSimpleMap loadSimplemap(const std::string& path) {
    CSimpleMap map;
    loadWhole(path, "a .simplemap", map);
    for (std::size_t i = 0; i < map.size(); ++i)
        if (!map.getAsPair(i).pose || !map.getAsPair(i).sf)
            throw Error("'" + path + "' has a key frame without a pose or without observations");
    return map;
}

std::vector<CPose3D> posesOf(const CSimpleMap& map) {
    std::vector<CPose3D> poses;
    for (std::size_t i = 0; i < map.size(); ++i)
        poses.push_back(map.getAsPair(i).pose->getMeanVal());
    return poses;
}

CPointsMapXYZI pointsOf(const CSimpleMap& map) {
    CPointsMapXYZI all;
    const auto poses = posesOf(map);
    for (std::size_t i = 0; i < map.size(); ++i) {
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
                    all.insertAnotherMap(scan->pointcloud.get(), poses[i] + scan->sensorPose);
                scan->unload();
            } else {
                mrpt::maps::CSimplePointsMap points;
                points.insertionOptions.minDistBetweenLaserPoints = 0;
                points.insertObservation(*observation, poses[i]);
                all.insertAnotherMap(&points, CPose3D());
            }
        }
    }
    return all;
}
}  // namespace delio::map
