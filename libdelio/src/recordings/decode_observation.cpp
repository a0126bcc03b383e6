#include "decode_observation.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationRotatingScan.h>
#include <mrpt/obs/CObservationVelodyneScan.h>
#include <mrpt/obs/VelodyneCalibration.h>

#include <cmath>
#include <string>

#include "core/portable_math.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "velodyne.h"

namespace delio::io {
using mrpt::maps::CPointsMapXYZI;
using mrpt::obs::CObservationRotatingScan;
using mrpt::obs::VelodyneCalibration;

namespace {
template <typename Image>
std::string sizeOf(const Image& image) {
    return std::to_string(image.rows()) + " x " + std::to_string(image.cols());
}

void checkSizes(const CObservationRotatingScan& scan) {
    if (scan.rangeImage.rows() != scan.rowCount)
        throw Error("a rotating scan with " + std::to_string(scan.rowCount) +
                    " rows has a range image with " + std::to_string(scan.rangeImage.rows()));
    const std::string range = sizeOf(scan.rangeImage), intensity = sizeOf(scan.intensityImage);
    if (scan.intensityImage.size() != 0 && intensity != range)
        throw Error("a rotating scan has an intensity image (" + intensity +
                    ") of another size than its range image (" + range + ")");
}

/** MRPT 2.5.8 cannot read its own table of 64 lasers. */
const VelodyneCalibration& calibrationOf(const CObservationRotatingScan& scan) {
    if (scan.rowCount != 16 && scan.rowCount != 32)
        throw Error("a rotating scan of model '" + scan.lidarModel + "' with " +
                    std::to_string(scan.rowCount) +
                    " rows is not supported: elevation angles are known for 16 and 32 rows only");
    return VelodyneCalibration::LoadDefaultCalibration(scan.rowCount == 16 ? "VLP16" : "HDL32");
}

bool isOfVelodyne(const CObservationRotatingScan& scan) {
    return scan.azimuthSpan > 0 && (scan.lidarModel == "VLP-16" || scan.lidarModel == "HDL-32E" ||
                                    scan.lidarModel == "Unknown");
}

int lastUsedColumn(const CObservationRotatingScan& scan) {
    for (int column = static_cast<int>(scan.rangeImage.cols()) - 1; column >= 0; --column)
        for (int row = 0; row < scan.rangeImage.rows(); ++row)
            if (scan.rangeImage(row, column) != 0) return column;
    return 0;
}

/** How many columns make the azimuth's span. fromVelodyne() makes the image 384 columns wide for
 *  each packet, modulo 65536, of which it fills 384 / rows, with dual returns half of that. */
int columnsOfSpan(const CObservationRotatingScan& scan, bool dual) {
    constexpr int kReturnsPerPacket = 384, kWrap = 65536, kMostWraps = 9;
    const int columns = static_cast<int>(scan.rangeImage.cols());
    if (!isOfVelodyne(scan)) return columns;
    const int last = lastUsedColumn(scan);
    for (int wide = columns; wide < columns + kMostWraps * kWrap; wide += kWrap) {
        const int used = wide / scan.rowCount / (dual ? 2 : 1);
        if (wide % kReturnsPerPacket == 0 && used > last) return used;
    }
    return columns;
}

/** Azimuths in radians, counter-clockwise from the front. */
class Azimuths {
 public:
    explicit Azimuths(const CObservationRotatingScan& scan)
        : velodyne_(isOfVelodyne(scan)),
          start_(scan.startAzimuth),
          // With dual returns, a VLP-16's columns come in pairs that share an azimuth.
          paired_(velodyne_ && scan.rowCount == 16 && !scan.rangeOtherLayers.empty()),
          perColumn_(scan.azimuthSpan / columnsOfSpan(scan, !scan.rangeOtherLayers.empty())),
          times_(firingTimes(scan.rowCount)) {}

    double at(int row, int column) const {
        if (!velodyne_) return start_ + perColumn_ * column;
        const double turned =
            (paired_ ? column - column % 2 : column) + times_.share(static_cast<std::size_t>(row));
        // Stored is Velodyne's clockwise azimuth, although the class says otherwise.
        return -(start_ + perColumn_ * turned);
    }

 private:
    bool velodyne_;
    double start_;
    bool paired_;
    double perColumn_;
    FiringTimes times_;
};
}  // namespace

void decodeRotatingScan(const CObservationRotatingScan& observation, Scan& scan) {
    if (observation.rangeImage.size() == 0) return;
    checkSizes(observation);
    const auto& lasers = calibrationOf(observation).laser_corrections;
    const Azimuths azimuths(observation);
    const int columns = columnsOfSpan(observation, !observation.rangeOtherLayers.empty());
    const bool withIntensity = observation.intensityImage.size() != 0;
    auto bright = withIntensity ? CPointsMapXYZI::Create() : nullptr;
    scan.points = bright;
    if (!bright) scan.points = mrpt::maps::CSimplePointsMap::Create();
    for (int row = 0; row < observation.rowCount; ++row) {
        const auto& laser = lasers[static_cast<std::size_t>(row)];
        for (int column = 0; column < observation.rangeImage.cols(); ++column) {
            const auto units = observation.rangeImage(row, column);
            const double range = units * observation.rangeResolution;
            if (units == 0 || !(range >= observation.minRange && range <= observation.maxRange))
                continue;
            const double azimuth = azimuths.at(row, column);
            const double flat = range * laser.cosVertCorrection;
            scan.points->insertPointFast(static_cast<float>(flat * portable::cos(azimuth)),
                                         static_cast<float>(flat * portable::sin(azimuth)),
                                         static_cast<float>(range * laser.sinVertCorrection));
            if (bright)
                bright->setPointIntensity(
                    bright->size() - 1,
                    static_cast<float>(observation.intensityImage(row, column)) / 255.0F);
            scan.rings.push_back(static_cast<std::uint16_t>(row));
            if (observation.sweepDuration > 0)
                scan.times_s.push_back(
                    static_cast<float>(observation.sweepDuration * column / columns));
        }
    }
}

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
            throw Error("its x, y and z have different lengths");
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
        throw Error("the pose of its sensor on the vehicle is not finite or exceeds 1e9 m");
    return scan;
}
}  // namespace delio::io
