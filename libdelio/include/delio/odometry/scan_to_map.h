#pragma once
#include <optional>
#include <vector>

#include "delio/odometry/scan_view.h"
#include "delio/planes/plane_map.h"
#include "delio/planes/plane_registration.h"
#include "delio/points/point_registration.h"

namespace delio {
/** How points and planes are weighed against each other. */
struct ScanToMapOptions : public StageOptions {
    double point_sigma = 0.05;
    double point_sigma_deg = 1.0;
    double believed = 0.1;
    double believed_deg = 3.0;
    double probe = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A scan in a map that is kept twice: as planes, which are precise, and as points, which cannot be
 *  fooled by what looks like a plane. Points place the scan first; both are fused by their
 *  information, where planes do not lead too far away. Poses map the sensor's frame to the map's.
 */
class ScanToMap {
 public:
    /** An empty map, z up. */
    ScanToMap(const ScanToMapOptions& options, const planes::PlaneMapOptions& planeMap,
              const planes::PlaneRegistrationOptions& planes,
              const points::PointMapOptions& pointMap,
              const points::PointRegistrationOptions& points)
        : options_(options),
          planeOptions_(planes),
          pointOptions_(points),
          planes_(planeMap),
          points_(pointMap) {}

    /** Takes `points` (metres, sensor's frame) in, where `pose` puts them. */
    void add(const Eigen::Matrix3Xf& points, const Eigen::Isometry3d& pose);
    /** `points`: in the map's frame; they turned out to move, and what is there goes. */
    void erase(const Eigen::Matrix3Xf& points);
    /** `up`: the unit vector that does, in the map's frame. */
    void clear(const Eigen::Vector3d& up);
    /** What it has as planes. */
    const planes::PlaneMap& planes() const { return planes_; }
    /** False where there are too few points to register anything against. */
    bool isUsable() const { return points_.size() >= pointOptions_.min_matches; }

    /** By points, from the prediction on; `kernel` (metres): how far that may be off. */
    points::PointEstimate place(const Eigen::Matrix3Xd& coarse, const Eigen::Isometry3d& predicted,
                                double kernel) const;

    /** By points, where `predicted` is a guess that may be off by `reach` metres in the plane that
     *  is level where `upright` turns the sensor's frame such that z is up. */
    points::PointEstimate placeAnywhere(const Eigen::Matrix3Xd& coarse,
                                        const Eigen::Isometry3d& predicted, double reach,
                                        const Eigen::Matrix3f& upright) const;

    /** By points, where the rotation of `predicted` may be off by up to 30 deg about any axis,
     * until a share of `enough` fits. */
    points::PointEstimate placeTurned(const Eigen::Matrix3Xd& coarse,
                                      const Eigen::Isometry3d& predicted, double enough) const;

    /** By planes, from where the points were placed; from where planes lead once more, if more
     *  points fit there. An axis that the planes see no better than the
     *  points stays where these put it, if they see it, else where the prediction does. Where
     *  points alone say that the scan stands where the map's `latest` does, the axis is unobserved,
     *  too, unless surfaces that face it confirm that: a sensor's own rings lie on each other
     *  anywhere. (None: the map is another drive's.) */
    planes::PlaneEstimate refine(const ScanView& view, const points::PointEstimate& placed,
                                 const Eigen::Isometry3d& predicted,
                                 const std::optional<Eigen::Isometry3d>& latest) const;

    /** Share of the points that lie within `distance` (metres) of one of the map's, 0 to 1. */
    double shareAt(const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
                   double distance) const {
        return points::shareAt(points_, points, pose, distance);
    }

 private:
    bool believes(const planes::PlaneEstimate& found, const points::PointEstimate& placed) const;
    Eigen::Matrix3d turnCovariance(const Eigen::Matrix3Xd& points,
                                   const points::PointEstimate& placed) const;
    planes::PlaneEstimate byPoints(const points::PointEstimate& placed,
                                   const Eigen::Matrix3d& turnCovariance) const;
    void settleUnobserved(const ScanView& view, const Eigen::Isometry3d& predicted,
                          const std::optional<Eigen::Isometry3d>& latest,
                          planes::PlaneEstimate& found) const;

    ScanToMapOptions options_;
    planes::PlaneRegistrationOptions planeOptions_;
    points::PointRegistrationOptions pointOptions_;
    planes::PlaneMap planes_;
    points::PointMap points_;
    Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();      //!< unit vector, map's frame
    Eigen::Vector3d swept_m_ = Eigen::Vector3d::Zero();  //!< where what is far was dropped last
};
}  // namespace delio
