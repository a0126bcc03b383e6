#pragma once
#include <Eigen/Geometry>
#include <deque>

#include "delio/core/geometry.h"
#include "delio/core/odometry_options.h"

namespace delio::odometry {
/** Section V, equation (linear prediction): T_p = 2/(N(N+1)) sum_{j=1..N} (N-j+1) T_{i-j}, the mean
 *  taken of logarithms in SE(3). While fewer than N increments are known, N is their
 *  number; with none the prediction is "no motion". */
class LinearPrediction {
 public:
    /** Of no motion yet. */
    explicit LinearPrediction(const PredictionOptions& options) : frames_(options.frames) {}

    /** The increment expected over the next `duration_s`: maps the coming frame to the present one.
     *  With equal durations it is the paper's equation. Otherwise the weighted sum of the motions
     * is divided by the weighted sum of their durations, so that a short interval counts little. */
    Eigen::Isometry3d predict(double duration_s = 1) const;

    /** False until an increment was observed: the prediction is a mere guess then. */
    bool hasMotion() const { return !latestFirst_.empty(); }

    /** Back to "no motion": after an interruption. */
    void forget() { latestFirst_.clear(); }

    /** Takes the registered increment and its duration (more than 0). */
    void observe(const Eigen::Isometry3d& increment, double duration_s = 1);

 private:
    std::size_t frames_;
    struct Observed {
        Eigen::Isometry3d increment = Eigen::Isometry3d::Identity();
        double duration_s;
    };
    std::deque<Observed> latestFirst_;
};

/** How many times larger than a motion model's standard deviation (prior_sigma, prior_sigma_deg)
 * the error of a prediction is, `unregistered_s` after the latest scan that was registered: they
 * are those of 0.1 s, and grow in proportion to the time, up to that of a minute. */
double errorGrowth(double unregistered_s);

/** The width of the registration's first kernel, from what the motion model was off lately (Vizzo
 *  et al., KISS-ICP: adaptive threshold). */
class AdaptiveKernel {
 public:
    /** What the pose turned out to be beside its prediction. */
    void observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& predicted);

    /** False while little is known. */
    bool isKnown() const;

    /** Three standard deviations, within these limits; `most` while little is known. Metres. */
    double width(double least, double most) const;

 private:
    std::deque<double> errors_m_;  //!< of the latest predictions
};

/** What is known of a motion before the planes are asked: standard deviations along (metres) and
 *  about (rad) each axis. */
struct TrajectoryPrior {
    double translation = 0.05;        //!< of the pose at the stamp
    double rotation = 0.02;           //!< likewise
    double unevenTranslation = 0.02;  //!< how far a motion between stamps is off constant speed
    double unevenRotation = 0.05;     //!< likewise
};

/** How uneven the sensor's motion is: how far it was off constant speed lately, from one scan to
 * the next. A vehicle on a road 0.1 deg, what a hand swings 10. */
class Unevenness {
 public:
    /** What an increment turned out to be beside what it would have been at constant speed. */
    void observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& even);

    /** Root mean square of the latest along (no more than `most` metres) and about each axis; while
     *  little is known, it may be anything that a hand does. */
    TrajectoryPrior prior(double most) const;

    /** The same of the latest `count` increments alone. */
    Unevenness ofLatest(std::size_t count) const;

 private:
    std::deque<double> squares_m2_, squares_rad2_;  //!< an axis
};
}  // namespace delio::odometry
