#pragma once
#include <memory>
#include <optional>
#include "delio/core/odometry_options.h"

#include "delio/odometry/odometry.h"
#include "odometry/arrivals.h"
#include "odometry/motion_model.h"
#include "odometry/paper_guards.h"
#include "odometry/preprocess.h"
#include "paper/line_cloud.h"
#include "paper/line_registration.h"
#include "paper/mean_shift.h"
#include "paper/normals.h"
#include "paper/outlier_removal.h"
#include "paper/pattern_registration.h"

namespace delio::odometry {
/** Scan `to` against scan `from`. */
struct PaperRegistration {
    Increment increment;              //!< maps the sensor's frame at `to` to that at `from`
    RotationEstimate rotation;        //!< by the patterns
    TranslationEstimate translation;  //!< by the lines
    /** Why rotation, translation or both are the prediction; empty where both were registered. */
    std::string predictedReason;
    bool denied = false;        //!< by the guard of points: registered again from elsewhere
    double rotation_ms = 0;     //!< time of the rotation
    double translation_ms = 0;  //!< time of the translation
    double guards_ms = 0;       //!< time of the guards, where there are any
};

/** Pattern of the normals and line cloud of a scan, in the sensor's frame. */
struct PaperFeatures : public ScanFeatures {
    paper::Pattern pattern;                               //!< of its normals
    paper::LineCloud lines;                               //!< between its rings
    std::optional<CheckPoints> check;                     //!< for the guard, where it is enabled
    std::shared_ptr<const PaperOdometryOptions> options;  //!< that they were made with

    std::optional<Link> linkTo(const ScanFeatures& earlier,
                               const Eigen::Isometry3d& guess) const override;
};

/** Sections III and IV-A: the pattern of the normals, and the lines. `upright` turns the cloud's
 *  frame such that the sensor spins about z; `number` of the scan: each draws other lines. Times
 * and figures go into `step`. */
std::shared_ptr<const PaperFeatures> featuresOf(
    const PointCloud& cloud, const Eigen::Matrix3f& upright, unsigned number,
    const std::shared_ptr<const PaperOdometryOptions>& options, Step& step);

/** Rotation from the patterns of the normals (III-D), once; then translation from the line clouds
 * of the unrotated scan (IV-B). `guess` maps frame `to` to frame `from`. With `search_m` > 0,
 *  translations up to so many metres off the guess are tried. */
PaperRegistration registerByPatternAndLines(const PaperFeatures& from, const PaperFeatures& to,
                                            const Eigen::Isometry3d& guess, double search_m,
                                            const PaperOdometryOptions& options);

/** The same, with the guards that the options enable. */
PaperRegistration registerFeatures(const PaperFeatures& from, const PaperFeatures& to,
                                   const Eigen::Isometry3d& guess, double search_m,
                                   const PaperOdometryOptions& options);

/** DeLiO as in the paper: rotation from the pattern of surface normals, the scan unrotated, then
 *  translation from line clouds, both from the linear prediction on, against the last usable
 *  scan. */
class PaperOdometry : public Odometry {
 public:
    /** Before the first scan. */
    explicit PaperOdometry(const PaperOdometryOptions& options);

    Step process(const Scan& scan) override;

 private:
    Eigen::Matrix3f upright() const;
    void takeIncrement(const PaperRegistration& registration, double duration_s, Step& step);

    std::shared_ptr<const PaperOdometryOptions> options_;
    Arrivals arrivals_;
    LinearPrediction prediction_;
    unsigned scans_ = 0;                              //!< processed
    std::shared_ptr<const PaperFeatures> reference_;  //!< the last usable scan
    /** Turns the sensor's frame such that it spins about z; of the first scan that shows how. */
    std::optional<Eigen::Matrix3f> upright_;
    /** Maps the latest frame to that of reference_. */
    Eigen::Isometry3d sinceReference_ = Eigen::Isometry3d::Identity();
    double sinceReference_s_ = 0;
    double unregistered_s_ = 0;  //!< since the latest scan that was registered
    bool lost_ = true;           //!< where the next scan will be is not known to better than metres
};
}  // namespace delio::odometry
