#pragma once
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
void addSample(const ImuSample& sample, std::vector<ImuSample>& samples);
}  // namespace delio::io
