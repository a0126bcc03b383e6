#include "delio/io/decode_observation.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/VelodyneCalibration.h>

#include <algorithm>
#include <cmath>

#include "delio/error.h"

namespace delio::io {
using mrpt::maps::CPointsMapXYZI;
using mrpt::obs::CObservation3DRangeScan;
using mrpt::obs::CObservationPointCloud;
using mrpt::obs::CObservationRotatingScan;
using mrpt::obs::CObservationVelodyneScan;

namespace {
void decode(const CObservationPointCloud& observation, Scan& scan) {
    scan.points = observation.pointcloud;
}

void decode(const CObservationVelodyneScan& observation, Scan& scan) {
    CObservationVelodyneScan packets = observation;
    if (packets.calibration.empty()) throw Error("a Velodyne scan without its calibration");
    packets.generatePointCloud();
    const auto& cloud = packets.point_cloud;
    auto points = CPointsMapXYZI::Create();
    points->resize(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        points->setPointFast(i, cloud.x[i], cloud.y[i], cloud.z[i]);
        points->setPointIntensity(i, static_cast<float>(cloud.intensity[i]) / 255.0F);
    }
    scan.points = points;
    scan.rings.assign(cloud.laser_id.begin(), cloud.laser_id.end());
}

/** MRPT's rotating scan has no elevation angles: they are those of the model with as many rows. */
const mrpt::obs::VelodyneCalibration& calibrationOf(const CObservationRotatingScan& observation) {
    const std::string name = observation.rowCount == 16   ? "VLP16"
                             : observation.rowCount == 32 ? "HDL32"
                             : observation.rowCount == 64 ? "HDL64"
                                                          : "";
    const auto& calibration = mrpt::obs::VelodyneCalibration::LoadDefaultCalibration(name);
    if (calibration.laser_corrections.size() != observation.rowCount)
        throw Error("a rotating scan of model '" + observation.lidarModel + "' with " +
                    std::to_string(observation.rowCount) +
                    " rows: its elevation angles are not known (16, 32 and 64 rows are)");
    return calibration;
}

/** CObservationRotatingScan::fromVelodyne() of MRPT 2.5.8 makes the image as many times too wide as
 *  it has rows, and leaves the rest empty. */
int usedColumns(const CObservationRotatingScan& observation) {
    const int columns = static_cast<int>(observation.rangeImage.cols());
    const int narrow = columns / std::max<int>(1, observation.rowCount);
    for (int column = narrow; column < columns; ++column)
        for (int row = 0; row < observation.rangeImage.rows(); ++row)
            if (observation.rangeImage(row, column) != 0) return columns;
    return narrow;
}

void decode(const CObservationRotatingScan& observation, Scan& scan) {
    const auto& calibration = calibrationOf(observation);
    const int columns = usedColumns(observation);
    // fromVelodyne() stores Velodyne's clockwise azimuth, although the class says that positive is
    // counter-clockwise; its scans are told by the model names that it writes.
    const bool clockwise = observation.azimuthSpan > 0 && (observation.lidarModel == "VLP-16" ||
                                                           observation.lidarModel == "HDL-32E" ||
                                                           observation.lidarModel == "Unknown");
    const double sign = clockwise ? -1 : 1;
    auto points = CPointsMapXYZI::Create();
    for (int row = 0; row < observation.rowCount; ++row) {
        const double elevation = mrpt::DEG2RAD(
            calibration.laser_corrections[static_cast<std::size_t>(row)].verticalCorrection);
        for (int column = 0; column < columns; ++column) {
            const double range = observation.rangeImage(row, column) * observation.rangeResolution;
            if (range < observation.minRange || range > observation.maxRange) continue;
            const double azimuth =
                sign * (observation.startAzimuth + observation.azimuthSpan * column / columns);
            const double flat = range * std::cos(elevation);
            points->insertPointFast(static_cast<float>(flat * std::cos(azimuth)),
                                    static_cast<float>(flat * std::sin(azimuth)),
                                    static_cast<float>(range * std::sin(elevation)));
            scan.rings.push_back(static_cast<std::uint16_t>(row));
        }
    }
    scan.points = points;
}

void decode(const CObservation3DRangeScan& observation, Scan& scan) {
    auto points = mrpt::maps::CSimplePointsMap::Create();
    if (observation.hasPoints3D) {
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
        decode(*image, scan);
    else if (const auto* depth = dynamic_cast<const CObservation3DRangeScan*>(&observation))
        decode(*depth, scan);
    if (!scan.points) scan.points = mrpt::maps::CSimplePointsMap::Create();
    observation.getSensorPose(scan.sensorPose);
    return scan;
}
}  // namespace delio::io
