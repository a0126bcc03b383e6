#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/poses/CPose3D.h>

#include <cstddef>
#include <string>
#include <vector>

#include "delio/stage_options.h"

namespace delio::map {
/** Which scans, and which of their points, a map keeps. */
struct MapOptions : StageOptions {
    double keyframeDistance_m = 2.0;
    double keyframeAngle_deg = 20.0;
    double voxelSize_m = 0.2;
    double minRange_m = 2.5;
    double maxRange_m = 60.0;

 protected:
    std::vector<OptionField> fields() override;
};

/** Collects scans while a drive goes on and gives the map once the final poses are known. Keeps
 *  only the thinned key scans (16 bytes a point). The same calls give the same points in the same
 *  order. All poses map the vehicle's coordinates to those of the world, in metres. */
class MapBuilder {
 public:
    /** `sensorLabel` becomes the label of the simplemap's observations. */
    explicit MapBuilder(const MapOptions& options, std::string sensorLabel = "lidar");

    /** Offers a scan; returns true if it became a key scan: the first one, and every one that is
     *  keyframeDistance_m or keyframeAngle_deg away from the key scan before it. Of its points,
     *  those between minRange_m and maxRange_m of the sensor are kept, the first of each voxel of
     *  voxelSize_m (0: all); points that are not finite are dropped. A scan without any usable
     *  point is never a key scan.
     *  @param poseIndex which of the final poses will be this scan's
     *  @param approximatePose only decides whether this is a key scan
     *  @param sensorPoints in the sensor's frame; intensities are kept of a CPointsMapXYZI
     *  @param sensorPose pose of the sensor in the vehicle
     *  @param stamp of the observation (MRPT takes time 0 for "no time") */
    bool add(std::size_t poseIndex, const mrpt::poses::CPose3D& approximatePose,
             const mrpt::maps::CPointsMap& sensorPoints, const mrpt::poses::CPose3D& sensorPose,
             mrpt::Clock::time_point stamp);

    std::size_t keyScans() const { return keyScans_.size(); }

    /** The key scans at the given poses, one CObservationPointCloud each with its points embedded.
     *  The poses' covariances are 0 ("not stated"). Shares the points with this builder. Throws
     *  Error if a key scan's poseIndex is outside `poses`. */
    mrpt::maps::CSimpleMap simplemap(const std::vector<mrpt::poses::CPose3D>& poses) const;

    /** The points of all key scans in the world's frame, the first of each voxel of voxelSize_m:
     *  what several scans saw is there once. Intensity 0 where a scan had none. Throws Error as
     *  above. */
    mrpt::maps::CPointsMapXYZI points(const std::vector<mrpt::poses::CPose3D>& poses) const;

 private:
    struct KeyScan {
        std::size_t poseIndex = 0;
        mrpt::poses::CPose3D sensorPose;
        mrpt::Clock::time_point stamp;
        mrpt::maps::CPointsMap::Ptr points;
    };

    MapOptions options_;
    std::string sensorLabel_;
    std::vector<KeyScan> keyScans_;
    mrpt::poses::CPose3D lastKeyPose_;
};
}  // namespace delio::map
