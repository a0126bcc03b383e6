#include "odometry_samples.h"

#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "imu_samples.h"
#include "mrpt/odometry_observation.h"

namespace delio::io {
using namespace mrpt::obs;

bool isOdometry(const Topic& topic) {
    const bool isOdometry =
        topic.type == "nav_msgs/Odometry" || topic.type == "nav_msgs/msg/Odometry";
    return isOdometry && !isResult(topic.name);
}

bool isResult(const std::string& name) {
    constexpr std::array kWords{"truth", "gt",     "slam", "lidar", "laser", "lio",
                                "loam",  "visual", "vio",  "gps",   "gnss",  "map"};
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::any_of(kWords.begin(), kWords.end(),
                       [&](const char* word) { return lower.find(word) != std::string::npos; });
}

std::optional<OdometrySample> odometryOf(const Message& message, std::string& frame) {
    try {
        WireReader in(message);
        OdometrySample sample;
        sample.stamp_s = in.header().stamp_s;
        if (sample.stamp_s == 0) sample.stamp_s = message.log_s;
        frame = in.text();
        Eigen::Vector3d position;
        Eigen::Vector4d quaternion;  // x y z w
        for (double& value : position) value = in.real();
        for (double& value : quaternion) value = in.real();
        if (!(quaternion.norm() > 0)) return {};
        sample.pose =
            isometry(Eigen::Quaterniond(quaternion.normalized()).toRotationMatrix(), position);
        return sample;
    } catch (const Error&) {
        return {};
    }
}

bool RawlogOdometry::isChosen(const std::string& name) {
    if (!name_ && !isResult(name)) name_ = name;
    return name_ == name;
}

void RawlogOdometry::add(const CObservation& observation, double stamp_s) {
    if (std::exchange(hasMoved_, false)) {
        OdometrySample sample;
        sample.stamp_s = stamp_s;
        sample.pose = moved_;
        addSample(sample, samples_);
    }
    const auto sample = odometryOf(observation, stamp_s);
    if (sample && isChosen("'" + observation.sensorLabel + "'")) addSample(*sample, samples_);
}

/** Motions that other programs estimated are no odometry of the vehicle. */
void RawlogOdometry::add(const CActionCollection& actions) {
    const auto move = [&](const mrpt::poses::CPose3D& increment) {
        const Eigen::Isometry3d moved = fromMrpt(increment);
        if (!moved.matrix().allFinite() || !isChosen("actions")) return;
        moved_ = normalised(moved_ * moved);
        hasMoved_ = true;
    };
    if (const auto flat = actions.getActionByClass<CActionRobotMovement2D>()) {
        if (flat->estimationMethod == CActionRobotMovement2D::emOdometry)
            move(mrpt::poses::CPose3D(flat->rawOdometryIncrementReading));
    } else if (const auto full = actions.getActionByClass<CActionRobotMovement3D>()) {
        if (full->estimationMethod == CActionRobotMovement3D::emOdometry)
            move(full->rawOdometryIncrementReading);
    }
}
}  // namespace delio::io
