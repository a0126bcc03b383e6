#include "odometry_observation.h"

#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include "delio/core/geometry.h"

namespace delio::io {
using namespace mrpt::obs;

std::optional<OdometrySample> odometryOf(const CObservation& observation, double stamp_s) {
    OdometrySample sample;
    sample.stamp_s = stamp_s;
    if (const auto* wheels = dynamic_cast<const CObservationOdometry*>(&observation)) {
        sample.pose = fromMrpt(mrpt::poses::CPose3D(wheels->odometry));
        return sample;
    }
    const auto* robot = dynamic_cast<const CObservationRobotPose*>(&observation);
    if (!robot) return {};
    sample.pose = fromMrpt(robot->pose.mean);
    const Eigen::Isometry3d frame = fromMrpt(robot->sensorPose);
    if (frame.matrix().allFinite()) sample.sensorPose = frame;
    return sample;
}

CObservation::Ptr observationOf(const OdometrySample& sample) {
    const mrpt::poses::CPose3D pose = toMrpt(sample.pose);
    const bool isFlat = pose.z() == 0 && pose.pitch() == 0 && pose.roll() == 0;
    if (isFlat && !sample.sensorPose) {
        auto wheels = CObservationOdometry::Create();
        wheels->odometry = mrpt::poses::CPose2D(pose);
        return wheels;
    }
    auto robot = CObservationRobotPose::Create();
    robot->pose.mean = pose;
    robot->pose.cov.setZero();  // not known
    if (sample.sensorPose) robot->sensorPose = toMrpt(*sample.sensorPose);
    return robot;
}
}  // namespace delio::io
