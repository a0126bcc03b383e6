#include "start.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "drive.h"

namespace delio::synth {
namespace {
/** Time goes slower at first: half of kSpeedUp_s is lost in all. */
class FromRest : public Motion {
 public:
    explicit FromRest(std::shared_ptr<const Motion> whole) : whole_(std::move(whole)) {}
    PlanPose at(double time_s) const override {
        const double t = std::max(0.0, time_s);
        return whole_->at(t < kSpeedUp_s ? t * t / (2 * kSpeedUp_s) : t - kSpeedUp_s / 2);
    }
    double duration_s() const override { return whole_->duration_s() + kSpeedUp_s / 2; }

 private:
    std::shared_ptr<const Motion> whole_;
};

class Later : public Motion {
 public:
    Later(std::shared_ptr<const Motion> whole, double begin_s)
        : whole_(std::move(whole)), begin_s_(begin_s) {}
    PlanPose at(double time_s) const override { return whole_->at(begin_s_ + time_s); }
    double duration_s() const override { return whole_->duration_s() - begin_s_; }

 private:
    std::shared_ptr<const Motion> whole_;
    double begin_s_;
};

double timeOf(std::size_t scan) { return kScanPeriod_s * static_cast<double>(scan); }

/** Metres from each scan to the next. */
std::vector<double> stepsOf(const Motion& motion) {
    std::vector<double> steps;
    for (std::size_t i = 0; i < scansBefore(Start::kMoving); ++i)
        if (timeOf(i + 1) <= motion.duration_s())
            steps.push_back(motion.at(timeOf(i + 1)).s - motion.at(timeOf(i)).s);
    return steps;
}
}  // namespace

std::size_t scansBefore(Start start) {
    return start == Start::kMoving
               ? static_cast<std::size_t>(std::lround(kSearch_s / kScanPeriod_s))
               : 0;
}

std::shared_ptr<const Motion> begun(std::shared_ptr<const Motion> motion, Start start) {
    constexpr double kFast = 0.9, kSlow = 0.2;  // of the fastest
    if (start == Start::kOfSeed) return motion;
    const auto steps = stepsOf(*motion);
    if (steps.empty()) return motion;
    const double fastest = *std::max_element(steps.begin(), steps.end());
    const bool stands = steps.front() < kSlow * fastest;
    if (stands == (start == Start::kRest)) return motion;
    if (start == Start::kRest) return std::make_shared<FromRest>(std::move(motion));
    const auto first = std::find_if(steps.begin(), steps.end(),
                                    [&](double step) { return step >= kFast * fastest; });
    const auto scan = static_cast<std::size_t>(first - steps.begin());
    return std::make_shared<Later>(std::move(motion), timeOf(scan));
}
}  // namespace delio::synth
