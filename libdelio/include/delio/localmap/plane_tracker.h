#pragma once
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Core>
#include <deque>
#include <string>

#include "delio/increment.h"
#include "delio/localmap/plane_map.h"
#include "delio/localmap/plane_registration.h"
#include "delio/prediction.h"
#include "delio/rotation/bilateral_filter.h"
#include "delio/rotation/normals.h"
#include "delio/rotation/pattern_registration.h"

namespace delio::localmap {
struct PlaneTrackerOptions : public StageOptions {
    bool enabled = false;
    double map_spacing = 0.25;
    double scan_spacing = 0.5;
    double lost_share = 0.93;

 protected:
    std::vector<OptionField> fields() override;
};

/** A scan placed in the map. */
struct Tracked {
    PlaneEstimate estimate;     //!< sensor to map
    mrpt::poses::CPose3D pose;  //!< the same, or the prediction
    bool predicted = false;     //!< the scan could not be placed
    std::string reason;         //!< why
    double register_ms = 0, map_ms = 0;
};

/** Registers scan after scan against the planes of those before. Where three in a row that are not
 *  empty cannot be placed (the recording was interrupted), a new map is begun at the prediction. */
class PlaneTracker {
 public:
    PlaneTracker(const PlaneTrackerOptions& options, const PlaneMapOptions& map,
                 const PlaneRegistrationOptions& registration,
                 const rotation::NormalsOptions& normals,
                 const rotation::BilateralFilterOptions& bilateral,
                 const rotation::PatternRegistrationOptions& pattern,
                 const PredictionOptions& prediction)
        : options_(options),
          registrationOptions_(registration),
          normalsOptions_(normals),
          bilateralOptions_(bilateral),
          patternOptions_(pattern),
          map_(map),
          prediction_(prediction) {}

    /** `points`: metres, sensor's frame. */
    Tracked track(const Eigen::Matrix3Xf& points, double stamp_s);

 private:
    PlaneEstimate place(const Eigen::Matrix3Xf& all, const Eigen::Matrix3Xd& points,
                        double duration_s) const;
    PlaneEstimate search(const rotation::SurfaceNormals& surfaces, const Eigen::Matrix3Xd& points,
                         const mrpt::poses::CPose3D& guess, double duration_s) const;
    rotation::SurfaceNormals surfacesOf(const Eigen::Matrix3Xf& points) const;
    void learn(const mrpt::poses::CPose3D& pose, const mrpt::poses::CPose3D& guess,
               const PlaneEstimate& estimate);
    double kernel() const;

    PlaneTrackerOptions options_;
    PlaneRegistrationOptions registrationOptions_;
    rotation::NormalsOptions normalsOptions_;
    rotation::BilateralFilterOptions bilateralOptions_;
    rotation::PatternRegistrationOptions patternOptions_;
    PlaneMap map_;
    LinearPrediction prediction_;
    mrpt::poses::CPose3D pose_;  //!< of the latest scan: sensor to map
    double stamp_s_ = 0;         //!< of the latest scan
    bool first_ = true;          //!< no scan was seen yet
    bool started_ = false;       //!< the map has planes
    bool lost_ = true;           //!< where the next scan will be is not known to better than metres
    std::deque<double> modelErrors_m_;  //!< of the latest predictions
    double usualShare_ = 0;             //!< of points on planes
    unsigned misses_ = 0;               //!< scans in a row that were not found in the map
    Eigen::Matrix3Xf latest_;           //!< points of the latest scan that was placed
    mrpt::poses::CPose3D latestPose_;   //!< its pose
};
}  // namespace delio::localmap
