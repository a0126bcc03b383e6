#pragma once
#include <Eigen/Geometry>
#include <deque>

#include "delio/core/stage_options.h"

namespace delio {
/** What motion is predicted from. */
struct PredictionOptions : public StageOptions {
    unsigned frames = 3;

 protected:
    std::vector<OptionField> fields() const override;
};

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

    /** Tells what the increment turned out to be, and how long (more than 0) it took. */
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
}  // namespace delio
