#include "imu_observation.h"

#include <array>
#include <cstddef>
#include <limits>

#include "delio/core/geometry.h"

namespace delio::io {
using namespace mrpt::obs;

namespace {
constexpr std::array kRates{IMU_WX, IMU_WY, IMU_WZ};
constexpr std::array kAccelerations{IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC};

Eigen::Vector3d valuesOf(const CObservationIMU& observation,
                         const std::array<TIMUDataIndex, 3>& indices) {
    Eigen::Vector3d values = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = 0; k < 3; ++k) {
        const auto index = static_cast<std::size_t>(indices[k]);
        if (index < observation.dataIsPresent.size() && observation.dataIsPresent[index] &&
            index < observation.rawMeasurements.size())
            values[static_cast<Eigen::Index>(k)] = observation.rawMeasurements[index];
    }
    return values;
}
}  // namespace

ImuSample sampleOf(const CObservationIMU& observation, double stamp_s) {
    ImuSample sample;
    sample.stamp_s = stamp_s;
    sample.rate_radps = valuesOf(observation, kRates);
    sample.acceleration_mps2 = valuesOf(observation, kAccelerations);
    const Eigen::Isometry3d pose = fromMrpt(observation.sensorPose);
    if (pose.matrix().allFinite()) sample.sensorPose = pose;
    return sample;
}

CObservationIMU observationOf(const ImuSample& sample) {
    CObservationIMU observation;
    if (sample.sensorPose) observation.sensorPose = toMrpt(*sample.sensorPose);
    const auto put = [&](const std::array<TIMUDataIndex, 3>& indices,
                         const Eigen::Vector3d& values) {
        if (!values.allFinite()) return;
        for (std::size_t k = 0; k < 3; ++k)
            observation.set(indices[k], values[static_cast<Eigen::Index>(k)]);
    };
    put(kRates, sample.rate_radps);
    put(kAccelerations, sample.acceleration_mps2);
    return observation;
}
}  // namespace delio::io
