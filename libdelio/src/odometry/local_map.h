#pragma once
#include <Eigen/Geometry>
#include <deque>
#include <optional>
#include <vector>
#include "delio/core/odometry_options.h"

#include "odometry/deskew.h"
#include "odometry/plane_map.h"
#include "odometry/point_map.h"
#include "odometry/register_planes.h"
#include "odometry/register_points.h"
#include "odometry/search_points.h"
#include "odometry/tuning.h"
#include "paper/normals.h"

namespace delio::odometry {
/** What is known of the sensor's motion before a scan is registered. */
enum class Motion {
    kUnknown,
    kSlow,  //!< predicted to be so slow that it may stand
    kFast
};

/** A scan in a map that is kept twice: as planes, which are precise, and as points, which cannot be
 *  fooled by what looks like a plane. Points place the scan first; both are fused by their
 *  information, where planes do not lead too far away. Poses map the sensor's frame to the map's.
 */
class LocalMap {
 public:
    /** An empty map, z up. */
    LocalMap(const LocalMapTuning& options, const PlaneMapOptions& planeMap,
             const PlaneRegistrationOptions& planes, const PointMapOptions& pointMap,
             const PointRegistrationOptions& points)
        : options_(options),
          planeOptions_(planes),
          pointOptions_(points),
          planes_(planeMap),
          points_(pointMap) {}

    /** Takes `points` (metres, sensor's frame) in, where `pose` puts them. */
    void add(const Eigen::Matrix3Xf& points, const Eigen::Isometry3d& pose);
    /** The same of an earlier scan of this drive. Its rings look the same from where it was. */
    void addScan(const Eigen::Matrix3Xf& points, const Eigen::Isometry3d& pose);
    /** Fits planes that the latest scan has changed, ahead of the next one. */
    void prepare() const { planes_.fitLatest(); }
    /** Removes the map at `points` (map's frame), which turned out to be dynamic. */
    void erase(const Eigen::Matrix3Xf& points);
    /** `up`: the unit vector that does, in the map's frame. */
    void clear(const Eigen::Vector3d& up);
    /** What it has as planes. */
    const PlaneMap& planes() const { return planes_; }
    /** False where there are too few points to register anything against. */
    bool isUsable() const { return points_.size() >= pointOptions_.min_matches; }

    /** By points, from the prediction on; `kernel` (metres): how far that may be off. */
    PointEstimate place(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& predicted,
                        double kernel) const;

    /** By points, where `predicted` is a guess that may be off by `reach`; the plane is level
     *  where `upright` turns the sensor's frame such that z is up. */
    PointEstimate placeAnywhere(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& predicted,
                                const SearchReach& reach, const Eigen::Matrix3f& upright) const;

    static constexpr double kTurned_rad = 0.55;
    /** By points, where the rotation of `predicted` may be off by up to `reach_rad` about any axis,
     * until a share of `enough` fits. */
    PointEstimate placeTurned(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& predicted,
                              double enough, double reach_rad = kTurned_rad) const;

    /** By points, where scans may be missing after the one at `latest` (sensor to map), while the
     *  sensor moved on by `increment` a scan. */
    PointEstimate placeOnward(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& latest,
                              const Eigen::Isometry3d& increment) const {
        return searchOnward(points_, coarse, latest, increment, pointOptions_);
    }

    /** By planes alone, from where the points of a cloud of many scans were placed: these see all
     *  rotations of it alike. */
    PlaneEstimate refine(const Eigen::Matrix3Xd& thinned, const PointEstimate& placed) const;

    /** Height, tilt and inlier ratio by all points of the scan, where it was placed by those that
     *  stand above the ground. These keep the rest. */
    PointEstimate levelled(const ScanView& view, PointEstimate placed) const;

    /** By planes, from where the points were placed; from where planes lead once more, if more
     *  points fit there. An axis that the planes see no better than the
     *  points stays where these put it, if they see it, else where the prediction does. Where
     *  points alone say that the scan is where an earlier scan of the drive was, the axis is
     *  unobserved, too, unless surfaces that face it confirm that: a sensor's own rings lie on each
     *  other anywhere. Unless the motion is fast, this holds for axes that the planes hardly
     *  constrain, too. `start` (sensor to map): where planes led before, if they did. */
    PlaneEstimate registerPlanes(const ScanView& view, const PointEstimate& placed,
                                 const Eigen::Isometry3d& predicted, Motion motion,
                                 const std::optional<Eigen::Isometry3d>& start = {}) const;

    /** Share of the points that lie within `distance` (metres) of one of the map's, 0 to 1. */
    double shareAt(const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
                   double distance) const {
        return odometry::shareAt(points_, points, pose, distance);
    }

 private:
    bool areNear(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) const;
    bool isNear(const PlaneEstimate& found, const Eigen::Isometry3d& pose) const {
        return found.valid && areNear(found.pose(), pose);
    }
    Eigen::Matrix3d turnCovariance(const Eigen::Matrix3Xd& points,
                                   const PointEstimate& placed) const;
    PlaneEstimate byPoints(const PointEstimate& placed,
                           const Eigen::Matrix3d& turnCovariance) const;
    void settleUnobserved(const ScanView& view, const Eigen::Isometry3d& predicted, Motion motion,
                          PlaneEstimate& found) const;
    bool isWhereAScanWas(const Eigen::Vector3d& place) const;

    LocalMapTuning options_;
    PlaneRegistrationOptions planeOptions_;
    PointRegistrationOptions pointOptions_;
    PlaneMap planes_;
    PointMap points_;
    Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();      //!< unit vector, map's frame
    std::deque<Eigen::Vector3d> origins_;                //!< of the drive's latest scans
    Eigen::Vector3d swept_m_ = Eigen::Vector3d::Zero();  //!< where what is far was dropped last
};

/** An empty map for clouds of many scans, with the default options. */
LocalMap mapOfManyScans();

/** A direction of the map's frame along which a scan may stand still. */
struct StandstillTest {
    Eigen::Vector3d axis;     //!< unit vector
    bool isVertical = false;  //!< nothing that the sensor sees moves along it together with it
    double probe = 0;         //!< metres: so far along the axis the scan must no longer fit
    double reach = 0;         //!< metres: surfaces and points of the map may be so far apart
};

/** True where the scan shows that the sensor did not move along the axis, away from `pose` (sensor
 *  to map), where the map was seen before. Rings on the ground and on smooth walls lie on earlier
 *  ones wherever the sensor is. So only surfaces that face the axis count. They have to lie on the
 *  map's points here, but not `probe` to either side; and to more than one side of the sensor,
 *  unlike a vehicle that drives ahead. `scan`: static surfaces, sensor's frame. */
bool showsStandstill(const PointMap& map, const paper::SurfaceNormals& scan,
                     const Eigen::Isometry3d& pose, const StandstillTest& test);
}  // namespace delio::odometry
