#pragma once
#include <array>
#include <memory>
#include <string>

#include "delio/increment.h"
#include "delio/localmap/plane_tracker.h"
#include "delio/prediction.h"
#include "delio/rotation/bilateral_filter.h"
#include "delio/rotation/mean_shift.h"
#include "delio/rotation/normals.h"
#include "delio/rotation/outlier_removal.h"
#include "delio/rotation/pattern_registration.h"
#include "delio/scan/preprocess.h"
#include "delio/scan/scan.h"
#include "delio/translation/line_cloud.h"
#include "delio/translation/line_registration.h"

namespace delio {
/** The options of each stage. */
struct OdometryOptions {
    scan::PreprocessOptions preprocess;
    rotation::NormalsOptions normals;
    rotation::BilateralFilterOptions bilateral;
    rotation::OutlierRemovalOptions outliers;
    rotation::MeanShiftOptions meanShift;
    rotation::PatternRegistrationOptions pattern;
    translation::LineCloudOptions lines;
    translation::LineRegistrationOptions lineRegistration;
    PredictionOptions prediction;
    localmap::PlaneTrackerOptions tracker;
    localmap::PlaneMapOptions planeMap;
    localmap::PlaneRegistrationOptions planes;
    localmap::MovingObjectsOptions moving;
    localmap::SegmentOptions segments;
};

/** Stages that time is measured of, in the order in which a scan goes through them. */
enum Stage {
    kPreprocess,
    kNormals,
    kBilateral,
    kOutliers,
    kMeanShift,
    kLines,
    kRotation,
    kTranslation,
    kMoving,
    kPlanes,
    kPlaneMap,
    kStages
};
constexpr std::array<const char*, kStages> kStageNames = {
    "preprocess", "normals",     "bilateral", "outliers", "mean_shift", "lines",
    "rotation",   "translation", "moving",    "planes",   "plane_map"};
using StageTimes = std::array<double, kStages>;  //!< milliseconds

/** What is kept of a scan to register others with; sensor's frame. */
struct Features {
    rotation::Pattern pattern;
    translation::LineCloud lines;
};

/** What can be said of a scan's features in numbers. */
struct FeatureCounts {
    std::size_t points = 0;     //!< used, after preprocessing
    std::size_t notFinite = 0;  //!< dropped: a coordinate was NaN or infinite
    std::size_t normals = 0;    //!< of surfaces
    std::size_t pattern = 0;    //!< normals, or cells of modes, left in the pattern
    std::size_t modes = 0;      //!< that mean shift found; 0 where it was not needed
    std::size_t lines = 0;
    std::size_t moving = 0;  //!< points that belong to what moves
};

/** The points of a scan that were used, as the sensor would have seen them all at once at the
 * stamp: metres, its frame, vertical angles corrected. */
struct UsedPoints {
    Eigen::Matrix3Xf points;
    std::vector<std::uint32_t> indices;  //!< of each in the scan as it came
    /** 1 for each that belongs to what moves; empty where that is not looked for. */
    std::vector<std::uint8_t> moving;
};

/** Scan `to` against scan `from`. */
struct Registration {
    Increment increment;  //!< maps the sensor's frame at `to` to that at `from`
    rotation::RotationEstimate rotation;
    translation::TranslationEstimate translation;
    /** Why rotation, translation or both are the prediction; empty where both were registered. */
    std::string predictedReason;
};

struct OdometryResult {
    /** Maps the sensor's frame at this scan to that at the scan before; identity for the first. */
    Increment increment;
    Registration registration;                 //!< against the last usable scan
    bool predicted = false;                    //!< the scan could not be registered
    std::string reason;                        //!< why
    std::shared_ptr<const Features> features;  //!< none where scans go against the map of planes
    UsedPoints used;
    bool deskewed = false;  //!< its points had times
    FeatureCounts counts;
    StageTimes times_ms{};
};

/** DeLiO, one scan after the other, rotation and translation decoupled. As in the paper: rotation
 *  from the pattern of surface normals, the scan unrotated, then translation from line clouds, both
 *  from the linear prediction on, against the last usable scan. With `tracker.enabled`: rotation
 *  from translation-free plane residuals, then translation alone, against a map of planes. A scan
 *  that cannot be registered takes the prediction. */
class Odometry {
 public:
    explicit Odometry(const OdometryOptions& options)
        : options_(options),
          prediction_(options.prediction),
          tracker_({options.tracker, options.planeMap, options.planes, options.moving,
                    options.segments, options.prediction, options.normals, options.bilateral,
                    options.pattern}) {}

    OdometryResult process(const Scan& scan);

    /** Registers any two scans; `guess` maps frame `to` to frame `from`. With `search_m` > 0,
     *  translations up to so many metres off the guess are tried. */
    Registration align(const Features& from, const Features& to, const mrpt::poses::CPose3D& guess,
                       double search_m, StageTimes& times_ms) const;

 private:
    std::shared_ptr<const Features> extract(const scan::PointCloud& cloud, FeatureCounts& counts,
                                            StageTimes& times_ms) const;
    OdometryResult processWithLastScan(const Scan& scan);
    OdometryResult processWithMap(const Scan& scan);

    OdometryOptions options_;
    LinearPrediction prediction_;
    unsigned scans_ = 0;                         //!< processed
    std::shared_ptr<const Features> reference_;  //!< the last usable scan
    mrpt::poses::CPose3D sinceReference_;        //!< maps the latest frame to that of reference_
    double sinceReference_s_ = 0;
    double stamp_s_ = 0;  //!< of the latest scan
    localmap::PlaneTracker tracker_;
    mrpt::poses::CPose3D tracked_;  //!< latest pose in the tracker's map
    bool lost_ = true;  //!< where the next scan will be is not known to better than metres
};
}  // namespace delio
