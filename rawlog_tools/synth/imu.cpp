#include "imu.h"

#include <mrpt/core/format.h>

#include <cmath>

#include "delio/core/geometry.h"
#include "random.h"

namespace delio::synth {
namespace {
using Eigen::Vector3d;

constexpr std::uint64_t kBiasKey = 0x1B1A, kSampleKey = 0x1B1B;
constexpr double kDegree = 3.14159265358979323846 / 180, kGravity = 9.81, kBefore_s = 0.3;

Vector3d normals(Random& random) {
    Vector3d values;
    for (double& value : values) value = random.normal();
    return values;
}

/** Mean rate of turn over an interval, in the LiDAR's axes: a gyroscope integrates between its
 *  samples. */
Vector3d rateAt(const Drive& drive, double time_s, double interval_s) {
    const Eigen::Matrix3d before = drive.lidarPoseAt(time_s - interval_s / 2).linear(),
                          after = drive.lidarPoseAt(time_s + interval_s / 2).linear();
    return rotationLog(before.transpose() * after) / interval_s;
}

/** Of what is at the LiDAR, with gravity, likewise. */
Vector3d accelerationAt(const Drive& drive, double time_s) {
    constexpr double kHalf_s = 5e-3;
    const Eigen::Isometry3d now = drive.lidarPoseAt(time_s);
    const Vector3d bent = drive.lidarPoseAt(time_s - kHalf_s).translation() +
                          drive.lidarPoseAt(time_s + kHalf_s).translation() - 2 * now.translation();
    return now.linear().transpose() * (bent / (kHalf_s * kHalf_s) + kGravity * Vector3d::UnitZ());
}
}  // namespace

std::vector<std::string> imuGrades() { return {"phone", "automotive"}; }

std::optional<ImuModel> imuOfGrade(const std::string& grade) {
    ImuModel model;
    if (grade == "phone") {
        model.rateNoise = 0.01 * kDegree;
        model.rateBias_radps = 0.5 * kDegree;
        model.rateWalk = 0.003 * kDegree;
        model.accelerationNoise = 0.002;
        model.accelerationBias_mps2 = 0.05;
    } else if (grade == "automotive") {
        model.rateNoise = 0.003 * kDegree;
        model.rateBias_radps = 0.05 * kDegree;
        model.rateWalk = 0.0003 * kDegree;
        model.accelerationNoise = 0.0005;
        model.accelerationBias_mps2 = 0.02;
    } else {
        return {};
    }
    return model;
}

Imu::Imu(const ImuModel& model, const Drive& drive, std::uint64_t seed)
    : model_(model), drive_(drive), seed_(seed) {
    Random random{seed, kBiasKey};
    for (double& bias : firstBias_)
        bias = random.chance(0.5) ? model.rateBias_radps : -model.rateBias_radps;
    bias_ = firstBias_;
    const double along = model.accelerationBias_mps2;
    for (double& bias : accelerationBias_) bias = random.chance(0.5) ? along : -along;
}

double Imu::timeOf(std::size_t sample) const {
    return static_cast<double>(sample) / model_.rate_hz - kBefore_s;
}

std::optional<ImuSample> Imu::next(double stamp_s) {
    const double time_s = timeOf(samples_);
    if (time_s + model_.offset_s > stamp_s) return {};
    Random random{seed_, kSampleKey, samples_};
    const double bandwidth = std::sqrt(model_.rate_hz);
    const Eigen::Matrix3d toImu = model_.mount.pose().linear().transpose();
    bias_ += model_.rateWalk / bandwidth * normals(random);
    ImuSample sample;
    sample.stamp_s = time_s + model_.offset_s;
    sample.rate_radps = toImu * rateAt(drive_, time_s, 1 / model_.rate_hz) + bias_ +
                        model_.rateNoise * bandwidth * normals(random);
    sample.acceleration_mps2 = toImu * accelerationAt(drive_, time_s) + accelerationBias_ +
                               model_.accelerationNoise * bandwidth * normals(random);
    ++samples_;
    return sample;
}

std::string Imu::truth() const {
    const auto& mount = model_.mount;
    const auto vector = [](const Vector3d& v) {
        return mrpt::format("[%.6f, %.6f, %.6f]", v.x(), v.y(), v.z());
    };
    return mrpt::format("rate_hz: %.6g\n", model_.rate_hz) +
           mrpt::format("mount_roll_pitch_yaw_deg: [%.6g, %.6g, %.6g]\n", mount.roll_deg,
                        mount.pitch_deg, mount.yaw_deg) +
           mrpt::format("offset_s: %.6g\n", model_.offset_s) +
           "first_bias_deg_per_s: " + vector(firstBias_ / kDegree) + "\n" +
           "last_bias_deg_per_s: " + vector(bias_ / kDegree) + "\n" +
           "acceleration_bias_mps2: " + vector(accelerationBias_) + "\n";
}
}  // namespace delio::synth
