#include "delio/io/decode_observation.h"

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "rotating_scan.h"
#include "velodyne_packets.h"

namespace delio::io {
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationPointCloud;
using mrpt::obs::CObservationRotatingScan;
using mrpt::obs::CObservationVelodyneScan;

namespace {
void decode(const CObservationPointCloud& observation, Scan& scan) {
    scan.points = observation.pointcloud;
}

void decode(const CObservationVelodyneScan& observation, Scan& scan) {
    decodeVelodynePackets(observation.scan_packets, observation.calibration, observation.minRange,
                          observation.maxRange, scan);
}

void decode(const CObservation3DRangeScan& observation, Scan& scan) {
    auto points = mrpt::maps::CSimplePointsMap::Create();
    if (observation.hasPoints3D) {
        const auto size = observation.points3D_x.size();
        if (observation.points3D_y.size() != size || observation.points3D_z.size() != size)
            throw Error("its points have unlike numbers of coordinates");
        points->resize(observation.points3D_x.size());
        for (std::size_t i = 0; i < observation.points3D_x.size(); ++i)
            points->setPointFast(i, observation.points3D_x[i], observation.points3D_y[i],
                                 observation.points3D_z[i]);
    } else if (observation.hasRangeImage) {
        CObservation3DRangeScan image = observation;
        image.unprojectInto(*points);
    }
    scan.points = points;
}
}  // namespace

bool isScan(const mrpt::obs::CObservation& observation) {
    return dynamic_cast<const CObservationPointCloud*>(&observation) ||
           dynamic_cast<const CObservationVelodyneScan*>(&observation) ||
           dynamic_cast<const CObservationRotatingScan*>(&observation) ||
           dynamic_cast<const CObservation3DRangeScan*>(&observation);
}

Scan decodeObservation(const mrpt::obs::CObservation& observation) {
    Scan scan;
    if (const auto* cloud = dynamic_cast<const CObservationPointCloud*>(&observation))
        decode(*cloud, scan);
    else if (const auto* packets = dynamic_cast<const CObservationVelodyneScan*>(&observation))
        decode(*packets, scan);
    else if (const auto* image = dynamic_cast<const CObservationRotatingScan*>(&observation))
        decodeRotatingScan(*image, scan);
    else if (const auto* depth = dynamic_cast<const CObservation3DRangeScan*>(&observation))
        decode(*depth, scan);
    if (!scan.points) scan.points = mrpt::maps::CSimplePointsMap::Create();
    mrpt::poses::CPose3D sensorPose;
    observation.getSensorPose(sensorPose);
    scan.sensorPose = fromMrpt(sensorPose);
    constexpr double kFarthest_m = 1e9;  // as the pose graph has it
    if (!scan.sensorPose.matrix().allFinite() ||
        !(scan.sensorPose.translation().cwiseAbs().maxCoeff() < kFarthest_m))
        throw Error("the pose of its sensor on the vehicle is not finite, or beyond 1e9 m");
    return scan;
}
}  // namespace delio::io
