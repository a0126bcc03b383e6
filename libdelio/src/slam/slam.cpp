#include "delio/slam/slam.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <utility>

#include "core/voxel_grid.h"
#include "delio/core/error.h"
#include "delio/core/stopwatch.h"

namespace delio {
Eigen::Matrix3Xf staticPoints(const SlamScan& scan) {
    constexpr Eigen::Index kMost = 20000;
    const auto& points = scan.step.used.points;
    const auto& dynamic = scan.step.used.dynamic;
    const auto moving = std::count(dynamic.begin(), dynamic.end(), std::uint8_t{1});
    // Every n-th point in sensor order, so that all azimuths are thinned alike.
    const Eigen::Index all = points.cols() - moving, stride = strideOf(all, kMost);
    Eigen::Matrix3Xf still(3, (all + stride - 1) / stride);
    Eigen::Index kept = 0, toPass = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        if (!dynamic.empty() && dynamic[static_cast<std::size_t>(i)]) continue;
        if (toPass == 0) {
            still.col(kept++) = points.col(i);
            toPass = stride;
        }
        --toPass;
    }
    return scan.scan.sensorPose.cast<float>() * still;
}

namespace {
/** Stands in for a listener that threw, so that every scan has the same columns in scans.csv. */
class SwitchedOff : public SlamListener {
 public:
    explicit SwitchedOff(std::string name) : name_(std::move(name)) {}
    const char* name() const override { return name_.c_str(); }
    void add(const SlamScan& /*scan*/) override {}

 private:
    std::string name_;
};

/** All later poses would be wrong, too. */
void requireFinite(const Increment& increment, const Scan& scan) {
    if (!increment.pose.matrix().allFinite() || !increment.covariance.allFinite())
        throw Error("scan " + std::to_string(scan.index) +
                    ": the odometry returned an increment that is not finite");
}
}  // namespace

void Slam::attach(std::shared_ptr<SlamListener> listener) {
    listeners_.push_back(std::move(listener));
}

void Slam::requireOpen() const {
    if (!odometry_) throw Error("the drive is finished and accepts no more scans");
}

void Slam::tell(const SlamScan& scan, ScanReport& report) {
    for (auto& listener : listeners_) {
        report.listeners_ms.emplace_back(listener->name(), 0);
        try {
            timed(report.listeners_ms.back().second, [&] { listener->add(scan); });
        } catch (const std::exception& e) {
            report.failed.push_back({listener, plainMessage(e)});
            listener = std::make_shared<SwitchedOff>(listener->name());
        }
    }
}

void Slam::settle() {
    requireOpen();
    odometry_->settle();
}

void Slam::addImu(const ImuSample& sample) {
    requireOpen();
    odometry_->addImu(sample);
}

std::optional<ImuReport> Slam::imuReport() const {
    requireOpen();
    return odometry_->imuReport();
}

void Slam::addOdometry(const OdometrySample& sample) {
    requireOpen();
    odometry_->addOdometry(sample);
}

std::optional<OdometryReport> Slam::odometryReport() const {
    requireOpen();
    return odometry_->odometryReport();
}

Eigen::AlignedBox3d Slam::ownVehicle() const {
    requireOpen();
    return odometry_->ownVehicle();
}

ScanReport Slam::process(const Scan& scan) {
    requireOpen();
    requireConsistent(scan);
    ScanReport report;
    report.step = odometry_->process(scan);
    requireFinite(report.step.increment, scan);
    auto& [poses, stamps_s] = trajectory_;
    SlamScan told{nodes_, scan, report.step, {}, Eigen::Isometry3d::Identity(), {}};
    if (nodes_ > 0) {
        told.increment = ofVehicle(report.step.increment, sensorPoses_.back(), scan.sensorPose);
        told.pose = poses.back() * told.increment.pose;
        for (const auto& corrected : report.step.corrected) {
            const auto& sensorThen = sensorPoses_.at(sensorPoses_.size() - corrected.scansAgo);
            told.corrected.push_back(
                {nodes_ - corrected.scansAgo,
                 told.pose * scan.sensorPose * corrected.pose * sensorThen.inverse()});
            if (corrected.staysInPlace)
                told.fromOldPose = told.corrected.back().pose.inverse() * poses.back();
        }
    }
    if (history_ == History::Last) {
        poses.clear();
        stamps_s.clear();
    } else
        for (const auto& [node, pose] : told.corrected) poses[node] = pose;
    poses.push_back(told.pose);
    stamps_s.push_back(scan.stamp_s);
    ++nodes_;
    constexpr std::size_t kMostCorrected = 64;
    sensorPoses_.push_back(scan.sensorPose);
    if (sensorPoses_.size() > kMostCorrected) sensorPoses_.pop_front();
    tell(told, report);
    return report;
}
}  // namespace delio
