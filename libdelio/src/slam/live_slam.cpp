#include "delio/slam/live_slam.h"

#include <utility>

#include "core/spread_threads.h"
#include "delio/core/error.h"

namespace delio {
LiveSlam::LiveSlam(std::unique_ptr<Slam> slam, std::size_t mostWaiting)
    : slam_(std::move(slam)), feed_(mostWaiting), thread_([this] { run(); }) {}

LiveSlam::~LiveSlam() { finish(); }

void LiveSlam::finish() {
    feed_.close();
    if (thread_.joinable()) thread_.join();
}

void LiveSlam::run() {
    const SpreadThreads spread;
    while (const auto item = feed_.take()) {
        std::string refusal;
        try {
            for (const ImuSample& sample : item->imu) slam_->addImu(sample);
            for (const OdometrySample& sample : item->odometry) slam_->addOdometry(sample);
            slam_->process(item->scan);
            slam_->settle();
        } catch (const std::exception& e) {
            refusal = plainMessage(e);
        }
        const std::lock_guard lock(mutex_);
        ++(refusal.empty() ? report_.processed : report_.refused);
        if (report_.refusal.empty()) report_.refusal = std::move(refusal);
    }
}

LiveSlam::Report LiveSlam::report() const {
    const std::lock_guard lock(mutex_);
    Report report = report_;
    report.dropped = feed_.dropped();
    return report;
}
}  // namespace delio
