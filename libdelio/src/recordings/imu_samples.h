#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/imu.h"
#include "message_source.h"

namespace delio::io {
/** True for sensor_msgs/Imu of ROS 1 and 2. */
bool isImu(const Topic& topic);

/** The sample of a sensor_msgs/Imu, stamped in Unix seconds as its header says, or with the time at
 *  which it was recorded where that is zero, and its frame_id. Nothing where the message cannot be
 * decoded. */
std::optional<ImuSample> sampleOf(const Message& message, std::string& frame);

/** Appends a sample. Where nobody takes them, the oldest of 200 000 are dropped. */
template <typename Sample>
void addSample(const Sample& sample, std::vector<Sample>& samples) {
    constexpr std::size_t kMost = 200'000;
    if (samples.size() >= kMost)
        samples.erase(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(kMost / 2));
    samples.push_back(sample);
}
}  // namespace delio::io
