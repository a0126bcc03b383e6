#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CSimpleMap.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "delio/core/stage_options.h"
#include "delio/map/map_point.h"

namespace delio::io {
class Spool;
}

namespace delio::map {
struct StoredScan;

/** Removal of dynamic objects from the map after the drive. */
struct RemovalOptions : StageOptions {
    bool enabled = true;
    double voxelSize_m = 0.2;
    double cell_deg = 0.4;
    double spacing_m = 0.5;

    // Not read from .ini files:
    double margin_m = 0.5;   //!< a beam that continued by this saw through a voxel
    unsigned witnesses = 2;  //!< minimum number of scans that saw through a dynamic voxel
    /** A voxel is static if this many times more scans hit it than saw through it. */
    double freePerTaken = 1.5;
    /** An uncertain voxel is dynamic if at least this fraction of its neighbours is. */
    double grownShare = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Scans and points kept in a map. */
struct MapOptions : StageOptions {
    double keyframeDistance_m = 2.0;
    double keyframeAngle_deg = 20.0;
    double voxelSize_m = 0.2;
    double minRange_m = 2.5;
    double maxRange_m = 60.0;
    RemovalOptions removal;  //!< a section of its own

    /** The options with the voxel size, the least range and the margin of the removal, which are
     *  given for streets, times `scale`. A length that has another value than by default, or was
     *  loaded from a text, stays. */
    MapOptions atScale(double scale) const;

    /** As StageOptions has it; notes which lengths the text sets (see atScale()). */
    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;

 private:
    bool voxelSizeIsSet_ = false, minRangeIsSet_ = false;  //!< loaded from a text
};

/** Map at the final poses, in the world frame. */
struct BuiltMap {
    /** Static points of all scans: the first point of each voxel of MapOptions::voxelSize_m. */
    MapPoints points;
    MapPoints dynamic;  //!< dynamic points, likewise
    /** The keyframes, one CObservationPointCloud each, without what is dynamic; load() fetches its
     *  points from the disk, and saveSimplemap() embeds them. The poses' covariances are 0 ("not
     *  stated"). */
    mrpt::maps::CSimpleMap simplemap;
    std::vector<Eigen::Isometry3d> keyPoses;  //!< of the keyframes
    double removal_ms = 0;                    //!< time of the removal of dynamic points
};

/** Collects scans during a drive and builds the map once the final poses are known. Only then are
 *  dynamic points identified, from all earlier and later scans. Scans are stored on disk, thinned;
 *  memory grows with the observed space, and only during build(); scans without labels need another
 *  byte for each stored point. The same calls give the same points in the same order. All poses map
 *  the vehicle's coordinates to those of the world, in metres. */
class MapBuilder {
 public:
    /** @param sensorLabel becomes the label of the simplemap's observations
     *  @param folder of the unnamed temporary file for scans; empty: the system's temporary folder
     */
    explicit MapBuilder(const MapOptions& options, std::string sensorLabel = "lidar",
                        std::string folder = "");
    ~MapBuilder();
    /** Moves; the other builder may only be destroyed. */
    MapBuilder(MapBuilder&&) noexcept;
    /** Likewise. */
    MapBuilder& operator=(MapBuilder&&) noexcept;

    /** `scale`: size of the place, see MapOptions::atScale(). No effect once there are scans. */
    void takeScale(double scale);
    /** Of the map, at the scale that was taken. */
    const MapOptions& options() const { return options_; }

    /** Adds a scan; returns true if it became a keyframe: the first one, and every one that is
     *  keyframeDistance_m or keyframeAngle_deg away from the keyframe before it. Its points between
     *  minRange_m and maxRange_m of the sensor are used, the first of each voxel of voxelSize_m (0:
     *  all); points that are not finite are left out. A scan without any usable point that stands
     *  still is never a keyframe. Throws Error if the scan cannot be stored; the builder is then
     *  unusable.
     *  @param poseIndex index of this scan's pose among the final poses
     *  @param approximatePose decides about the keyframe, and the voxels of the points
     *  @param sensorPoints in the sensor's frame; intensities are kept of a CPointsMapXYZI
     *  @param sensorPose pose of the sensor in the vehicle
     *  @param stamp of the observation (MRPT takes time 0 for "no time")
     *  @param moving 1 for each of `sensorPoints` labelled as dynamic, otherwise 0; empty: not
     *  known. If no scan has labels, build() finds moving objects itself.
     */
    bool add(std::size_t poseIndex, const Eigen::Isometry3d& approximatePose,
             const mrpt::maps::CPointsMap& sensorPoints, const Eigen::Isometry3d& sensorPose,
             mrpt::Clock::time_point stamp, const std::vector<std::uint8_t>& moving = {});

    /** The pose of the scan that was added last is known better, but its points stay where they
     *  were. No effect for another scan.
     *  @param poseIndex of that scan
     *  @param fromOldPose maps the vehicle's coordinates at the old pose to those at the new one
     */
    void keepInPlace(std::size_t poseIndex, const Eigen::Isometry3d& fromOldPose);

    std::size_t keyframes() const { return keyframes_; }  //!< among the scans that were added

    /** The map at the given poses. Throws Error if a scan's poseIndex is outside `poses`. */
    BuiltMap build(const std::vector<Eigen::Isometry3d>& poses) const;

    /** For each of `points` (metres, world frame) 1 where the scans saw through it, as they do
     *  through points of dynamic objects; otherwise 0. Only scans whose poses are `usable` count
     *  (empty: all). 0 without RemovalOptions::enabled. Throws Error as build() does. */
    std::vector<std::uint8_t> seenThrough(const Eigen::Matrix3Xf& points,
                                          const std::vector<Eigen::Isometry3d>& poses,
                                          const std::vector<bool>& usable = {}) const;

 private:
    bool isFarFromLastKeyframe(const Eigen::Isometry3d& pose) const;
    bool isFarFromLastView(const Eigen::Isometry3d& pose, mrpt::Clock::time_point stamp) const;
    void putAside(const std::vector<float>& points, const mrpt::maps::CPointsMap* view,
                  StoredScan& scan);

    MapOptions given_, options_;  //!< as they were given, and at the scale
    double scale_ = 1;
    std::string sensorLabel_, folder_;
    std::vector<StoredScan> scans_;
    std::shared_ptr<io::Spool> spool_;  //!< made with the first scan
    std::size_t keyframes_ = 0, views_ = 0;
    Eigen::Isometry3d keyPose_ = Eigen::Isometry3d::Identity();   //!< of the last keyframe
    Eigen::Isometry3d viewPose_ = Eigen::Isometry3d::Identity();  //!< of the last view
    mrpt::Clock::time_point viewStamp_;
};
}  // namespace delio::map
