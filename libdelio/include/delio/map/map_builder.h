#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimpleMap.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "delio/core/stage_options.h"

namespace delio::io {
class Spool;
}

namespace delio::map {
class VoxelSet;

/** Which scans, and which of their points, a map keeps. */
struct MapOptions : StageOptions {
    double keyframeDistance_m = 2.0;
    double keyframeAngle_deg = 20.0;
    double voxelSize_m = 0.2;
    double minRange_m = 2.5;
    double maxRange_m = 60.0;

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Collects scans while a drive goes on and gives the map once the final poses are known. Of each
 *  scan it keeps the points in voxels that no scan was in before (16 bytes each, so that memory
 *  grows with the space that was seen and not with the number of scans); keyframes are kept whole,
 *  but on the disk. The same calls give the same points in the same order. All poses map the
 *  vehicle's coordinates to those of the world, in metres. */
class MapBuilder {
 public:
    /** @param sensorLabel becomes the label of the simplemap's observations
     *  @param folder where keyframes are put aside, in a file without a name; empty: the system's
     *  folder for temporary files */
    explicit MapBuilder(const MapOptions& options, std::string sensorLabel = "lidar",
                        std::string folder = "");
    ~MapBuilder();
    MapBuilder(MapBuilder&&) noexcept;
    MapBuilder& operator=(MapBuilder&&) noexcept;

    /** Adds a scan; returns true if it became a keyframe: the first one, and every one that is
     *  keyframeDistance_m or keyframeAngle_deg away from the keyframe before it. Its points between
     *  minRange_m and maxRange_m of the sensor are used, the first of each voxel of voxelSize_m
     *  (0: all); points that are not finite, and those that move, are left out. A scan without any
     *  usable point is never a keyframe. If the disk is full, there are no more keyframes, and
     *  simplemap() says so. Whatever is thrown, the map is as it was before.
     *  @param poseIndex which of the final poses will be this scan's
     *  @param approximatePose decides whether this is a keyframe, and which of its points are in
     *  voxels that were seen before
     *  @param sensorPoints in the sensor's frame; intensities are kept of a CPointsMapXYZI
     *  @param sensorPose pose of the sensor in the vehicle
     *  @param stamp of the observation (MRPT takes time 0 for "no time")
     *  @param moving 1 for each of `sensorPoints` that belongs to a moving object, otherwise 0;
     *  empty: none does */
    bool add(std::size_t poseIndex, const Eigen::Isometry3d& approximatePose,
             const mrpt::maps::CPointsMap& sensorPoints, const Eigen::Isometry3d& sensorPose,
             mrpt::Clock::time_point stamp, const std::vector<std::uint8_t>& moving = {});

    /** Takes the last add() back: the map is as if that scan had never come. Of add()s only the
     *  last can be taken back, and once. */
    void undo() noexcept;

    std::size_t keyframes() const;

    /** The keyframes at the given poses, one CObservationPointCloud each; load() fetches its points
     *  from the disk, and saveSimplemap() embeds them. The poses' covariances are 0 ("not stated").
     *  Throws Error if a keyframe's poseIndex is outside `poses`, or if one could not be put aside.
     */
    mrpt::maps::CSimpleMap simplemap(const std::vector<Eigen::Isometry3d>& poses) const;

    /** Those of the poses that belong to keyframes, in their order. Throws Error for a poseIndex
     *  outside `poses`. */
    std::vector<Eigen::Isometry3d> keyPoses(const std::vector<Eigen::Isometry3d>& poses) const;

    /** The points of all scans in the world's frame, the first of each voxel of voxelSize_m: what
     *  several scans saw is there once. Intensity 0 where a scan had none. Throws Error as above.
     */
    mrpt::maps::CPointsMapXYZI points(const std::vector<Eigen::Isometry3d>& poses) const;

 private:
    struct Keyframe;
    struct Point {
        float x, y, z, intensity;
    };
    struct NewPoints {
        std::size_t poseIndex = 0;
        Eigen::Isometry3d sensorPose = Eigen::Isometry3d::Identity();
        std::vector<Point> points;  //!< in the sensor's frame
    };
    /** What the last add() changed. */
    struct LastAdd {
        bool points = false, keyframe = false, spoolFault = false;
        Eigen::Isometry3d sensorInWorld = Eigen::Isometry3d::Identity();
        Eigen::Isometry3d keyPoseBefore = Eigen::Isometry3d::Identity();
    };
    struct Input;

    bool isFarFromLastKeyframe(const Eigen::Isometry3d& pose) const;
    /** Moves what is new into `fresh`; returns the points of a keyframe as the spool wants them,
     *  none if `isKeyframe` is false. */
    std::vector<float> sift(const Input& scan, bool isKeyframe, std::vector<Point>& fresh);
    void keep(Keyframe keyframe, const std::vector<float>& points);

    MapOptions options_;
    std::string sensorLabel_, folder_;
    std::vector<NewPoints> scans_;
    std::unique_ptr<VoxelSet> seen_;
    std::vector<Keyframe> keyframes_;
    std::shared_ptr<io::Spool> spool_;  //!< made with the first keyframe
    std::string spoolFault_;            //!< why a keyframe could not be put aside
    Eigen::Isometry3d lastKeyPose_ = Eigen::Isometry3d::Identity();
    LastAdd last_;
};
}  // namespace delio::map
