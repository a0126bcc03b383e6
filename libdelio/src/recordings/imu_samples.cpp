#include "imu_samples.h"

#include <limits>

#include "delio/core/error.h"

namespace delio::io {
namespace {
/** Three numbers and their covariance, whose first element is -1 where they were not measured. */
Eigen::Vector3d measuredIn(WireReader& in) {
    constexpr unsigned kCovariance = 9;
    Eigen::Vector3d values;
    for (double& value : values) value = in.real();
    const bool isMeasured = in.real() != -1;
    for (unsigned i = 1; i < kCovariance; ++i) in.real();
    if (!isMeasured) values.setConstant(std::numeric_limits<double>::quiet_NaN());
    return values;
}
}  // namespace

bool isImu(const Topic& topic) {
    return topic.type == "sensor_msgs/Imu" || topic.type == "sensor_msgs/msg/Imu";
}

std::optional<ImuSample> sampleOf(const Message& message, std::string& frame) {
    constexpr unsigned kOrientation = 13;  // a quaternion and its covariance
    try {
        WireReader in(message);
        ImuSample sample;
        const auto header = in.header();
        frame = header.frame;
        sample.stamp_s = header.stamp_s;
        if (sample.stamp_s == 0) sample.stamp_s = message.log_s;
        for (unsigned i = 0; i < kOrientation; ++i) in.real();
        sample.rate_radps = measuredIn(in);
        sample.acceleration_mps2 = measuredIn(in);
        return sample;
    } catch (const Error&) {
        return {};
    }
}

}  // namespace delio::io
