#pragma once
#include <mrpt/poses/CPose3D.h>

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "delio/localmap/moving_objects.h"
#include "delio/localmap/plane_map.h"
#include "delio/localmap/plane_registration.h"
#include "delio/prediction.h"
#include "delio/rotation/bilateral_filter.h"
#include "delio/rotation/normals.h"
#include "delio/rotation/pattern_registration.h"
#include "delio/scan/deskew.h"
#include "delio/scan/preprocess.h"

namespace delio::localmap {
struct PlaneTrackerOptions : public StageOptions {
    bool enabled = false;
    double map_spacing = 0.25;
    double scan_spacing = 0.5;
    double lost_share = 0.93;

 protected:
    std::vector<OptionField> fields() override;
};

/** The options of all that a tracker does. */
struct TrackingOptions {
    PlaneTrackerOptions tracker;
    PlaneMapOptions map;
    PlaneRegistrationOptions registration;
    MovingObjectsOptions moving;
    SegmentOptions segments;
    PredictionOptions prediction;
    /** Of the surfaces by which a scan is found again. */
    rotation::NormalsOptions normals;
    rotation::BilateralFilterOptions bilateral;
    rotation::PatternRegistrationOptions pattern;
};

/** A scan placed in the map. */
struct Tracked {
    PlaneEstimate estimate;            //!< sensor to map
    mrpt::poses::CPose3D pose;         //!< the same, or the prediction
    bool predicted = false;            //!< the scan could not be placed
    std::string reason;                //!< why
    Eigen::Matrix3Xf points;           //!< of the cloud, all as seen at the stamp
    std::vector<std::uint8_t> moving;  //!< 1 for each of these points that belongs to what moves
    double register_ms = 0, moving_ms = 0, map_ms = 0;
};

/** Registers scan after scan against the planes of those before, without what moves. Where three in
 *  a row that are not empty cannot be placed (the recording was interrupted), a new map is begun at
 *  the prediction. Scans whose points have times are de-skewed twice: by the predicted motion, and
 *  by the one that was found. */
class PlaneTracker {
 public:
    explicit PlaneTracker(const TrackingOptions& options)
        : options_(options),
          map_(options.map),
          movingObjects_(options.moving, options.segments),
          prediction_(options.prediction) {}

    Tracked track(const scan::PointCloud& cloud, double stamp_s);

 private:
    /** A scan as it is registered, in the sensor's frame at the stamp: what moves is left out of
     *  the thinned points. */
    struct View {
        Eigen::Matrix3Xf points;           //!< all
        std::vector<std::uint8_t> moving;  //!< each of them
        Eigen::Matrix3Xf fine;             //!< for the map
        Eigen::Matrix3Xd thinned;          //!< for registration
    };
    View viewOf(const scan::PointCloud& cloud, const Motion& motion) const;
    void thinWithoutWhatMoves(View& view, const mrpt::poses::CPose3D& pose);
    PlaneEstimate place(const View& view, const mrpt::poses::CPose3D& guess,
                        double duration_s) const;
    PlaneEstimate search(const rotation::SurfaceNormals& surfaces, const Eigen::Matrix3Xd& points,
                         const mrpt::poses::CPose3D& guess, double duration_s) const;
    rotation::SurfaceNormals surfacesOf(const Eigen::Matrix3Xf& points) const;
    void learn(const mrpt::poses::CPose3D& pose, const mrpt::poses::CPose3D& guess,
               const PlaneEstimate& estimate);
    double kernel() const;
    void begin(const scan::PointCloud& cloud, Tracked& result);
    void follow(const scan::PointCloud& cloud, double duration_s, Tracked& result);
    void insert(const View& view, const mrpt::poses::CPose3D& pose);
    void thin(View& view) const;
    void refine(const scan::PointCloud& cloud, double since_s, View& view, PlaneEstimate& estimate);

    TrackingOptions options_;
    PlaneMap map_;
    MovingObjects movingObjects_;
    LinearPrediction prediction_;
    mrpt::poses::CPose3D pose_;  //!< of the latest scan: sensor to map
    double stamp_s_ = 0;         //!< of the latest scan
    double time_s_ = 0;          //!< since the first scan, rising whatever the stamps do
    bool first_ = true;          //!< no scan was seen yet
    bool started_ = false;       //!< the map has planes
    bool lost_ = true;           //!< where the next scan will be is not known to better than metres
    std::deque<double> modelErrors_m_;  //!< of the latest predictions
    double usualShare_ = 0;             //!< of points on planes
    unsigned misses_ = 0;               //!< scans in a row that were not found in the map
    Eigen::Matrix3Xf latest_;           //!< points of the latest scan that was placed
    mrpt::poses::CPose3D latestPose_;   //!< its pose
    double latestTime_s_ = 0;           //!< and its time
    /** The scan that the map began with, while the motion during it is not known. */
    std::optional<scan::PointCloud> skewed_;
};
}  // namespace delio::localmap
