#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/poses/CPose3D.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "delio/stage_options.h"

namespace delio::map {
class ScanSpool;
class VoxelSet;

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

/** Collects scans while a drive goes on and gives the map once the final poses are known. Of each
 *  scan it keeps the points in voxels that no scan was in before (16 bytes each, so that memory
 *  grows with the space that was seen and not with the number of scans); key scans are kept whole,
 *  but on the disk. The same calls give the same points in the same order. All poses map the
 *  vehicle's coordinates to those of the world, in metres. */
class MapBuilder {
 public:
    /** @param sensorLabel becomes the label of the simplemap's observations
     *  @param folder where key scans are put aside, in a file without a name; empty: the system's
     *  folder for temporary files */
    explicit MapBuilder(const MapOptions& options, std::string sensorLabel = "lidar",
                        std::string folder = "");
    ~MapBuilder();
    MapBuilder(MapBuilder&&) noexcept;
    MapBuilder& operator=(MapBuilder&&) noexcept;

    /** Adds a scan; returns true if it became a key scan: the first one, and every one that is
     *  keyframeDistance_m or keyframeAngle_deg away from the key scan before it. Its points between
     *  minRange_m and maxRange_m of the sensor are used, the first of each voxel of voxelSize_m
     *  (0: all); points that are not finite, and those that move, are left out. A scan without any
     *  usable point is never a key scan. If the disk is full, there are no more key scans, and
     *  simplemap() says so.
     *  @param poseIndex which of the final poses will be this scan's
     *  @param approximatePose decides whether this is a key scan, and which of its points are in
     *  voxels that were seen before
     *  @param sensorPoints in the sensor's frame; intensities are kept of a CPointsMapXYZI
     *  @param sensorPose pose of the sensor in the vehicle
     *  @param stamp of the observation (MRPT takes time 0 for "no time")
     *  @param moving 1 for each of `sensorPoints` that belongs to a moving object, otherwise 0;
     *  empty: none does */
    bool add(std::size_t poseIndex, const mrpt::poses::CPose3D& approximatePose,
             const mrpt::maps::CPointsMap& sensorPoints, const mrpt::poses::CPose3D& sensorPose,
             mrpt::Clock::time_point stamp, const std::vector<std::uint8_t>& moving = {});

    std::size_t keyScans() const;

    /** The key scans at the given poses, one CObservationPointCloud each; load() fetches its points
     *  from the disk, and saveSimplemap() embeds them. The poses' covariances are 0 ("not stated").
     *  Throws Error if a key scan's poseIndex is outside `poses`, or if one could not be put aside.
     */
    mrpt::maps::CSimpleMap simplemap(const std::vector<mrpt::poses::CPose3D>& poses) const;

    /** Those of the poses that belong to key scans, in their order. Throws Error for a poseIndex
     *  outside `poses`. */
    std::vector<mrpt::poses::CPose3D> keyPoses(
        const std::vector<mrpt::poses::CPose3D>& poses) const;

    /** The points of all scans in the world's frame, the first of each voxel of voxelSize_m: what
     *  several scans saw is there once. Intensity 0 where a scan had none. Throws Error as above.
     */
    mrpt::maps::CPointsMapXYZI points(const std::vector<mrpt::poses::CPose3D>& poses) const;

 private:
    struct KeyScan;
    struct Point {
        float x, y, z, intensity;
    };
    struct NewPoints {
        std::size_t poseIndex = 0;
        mrpt::poses::CPose3D sensorPose;
        std::vector<Point> points;  //!< in the sensor's frame
    };

    MapOptions options_;
    std::string sensorLabel_, folder_;
    std::vector<NewPoints> scans_;
    std::unique_ptr<VoxelSet> seen_;
    std::vector<KeyScan> keyScans_;
    std::shared_ptr<ScanSpool> spool_;  //!< made with the first key scan
    std::string spoolFault_;            //!< why a key scan could not be put aside
    mrpt::poses::CPose3D lastKeyPose_;
};
}  // namespace delio::map
