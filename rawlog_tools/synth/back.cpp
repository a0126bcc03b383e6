#include "back.h"

#include <cmath>
#include <utility>

namespace delio::synth {
namespace {
class Back : public Motion {
 public:
    Back(std::shared_ptr<const Motion> motion, double end_s, double aside_m)
        : motion_(std::move(motion)), end_s_(end_s), aside_m_(aside_m) {}

    PlanPose at(double time_s) const override {
        constexpr double kHalfTurn = 3.14159265358979323846;
        PlanPose pose = motion_->at(end_s_ - time_s);
        pose.x -= aside_m_ * std::sin(pose.yaw);
        pose.y += aside_m_ * std::cos(pose.yaw);
        pose.yaw += kHalfTurn;
        return pose;
    }
    double duration_s() const override { return end_s_; }

 private:
    std::shared_ptr<const Motion> motion_;
    double end_s_, aside_m_;
};
}  // namespace

std::shared_ptr<const Motion> drivenBack(std::shared_ptr<const Motion> motion, double end_s,
                                         double aside_m) {
    return std::make_shared<Back>(std::move(motion), end_s, aside_m);
}
}  // namespace delio::synth
