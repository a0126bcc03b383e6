#include "delio/slam/slam.h"

#include <string>

#include "delio/core/error.h"
#include "delio/core/stopwatch.h"

namespace delio {
namespace {
/** All poses after it would be what it is. */
void requireFinite(const Increment& increment, const Scan& scan) {
    if (!increment.pose.matrix().allFinite() || !increment.covariance.allFinite())
        throw Error("scan " + std::to_string(scan.index) +
                    ": the odometry gave an increment that is not finite");
}
}  // namespace

void Slam::attach(std::shared_ptr<SlamListener> listener) {
    listeners_.push_back(std::move(listener));
}

void Slam::requireOpen() const {
    if (!odometry_) throw Error("the drive is closed: it takes no more scans");
}

/** All listeners are told, or none. */
void Slam::tell(const SlamScan& scan, ScanReport& report) {
    std::size_t told = 0;
    try {
        for (; told < listeners_.size(); ++told) {
            report.listeners_ms.emplace_back(listeners_[told]->name(), 0);
            timed(report.listeners_ms.back().second, [&] { listeners_[told]->add(scan); });
        }
    } catch (...) {
        while (told > 0) listeners_[--told]->undo();
        throw;
    }
}

ScanReport Slam::process(const Scan& scan) {
    requireOpen();
    requireConsistent(scan);
    ScanReport report{odometry_->process(scan), {}};
    requireFinite(report.step.increment, scan);
    auto& [poses, stamps_s] = trajectory_;
    const std::size_t node = nodes_, kept = poses.size();
    Increment increment;  // since the last scan that was taken
    SlamScan told{node, scan, report.step, {}, Eigen::Isometry3d::Identity()};
    if (node > 0) {
        increment = refused_ ? chained(*refused_, report.step.increment) : report.step.increment;
        told.increment = ofVehicle(increment, sensorPose_, scan.sensorPose);
        told.pose = poses.back() * told.increment.pose;
    }
    try {
        poses.push_back(told.pose);
        stamps_s.push_back(scan.stamp_s);
        tell(told, report);
    } catch (...) {
        poses.resize(kept);
        stamps_s.resize(kept);
        if (node > 0) refused_ = increment;
        throw;
    }
    if (history_ == History::Last) {
        poses.erase(poses.begin(), poses.end() - 1);
        stamps_s.erase(stamps_s.begin(), stamps_s.end() - 1);
    }
    ++nodes_;
    sensorPose_ = scan.sensorPose;
    refused_.reset();
    return report;
}
}  // namespace delio
