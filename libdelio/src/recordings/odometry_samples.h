#pragma once
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/odometry/wheels.h"
#include "message_source.h"

namespace delio::io {
/** The name of a topic or label is that of a result or of ground truth: no odometry of the vehicle.
 */
bool isResult(const std::string& name);

/** True for nav_msgs/Odometry of ROS 1 and 2, unless its name is that of a result. */
bool isOdometry(const Topic& topic);

/** The sample of a nav_msgs/Odometry, stamped in Unix seconds as its header says, or with the time
 *  at which it was recorded where that is zero, and its child_frame_id. Nothing where the message
 *  cannot be decoded. */
std::optional<OdometrySample> odometryOf(const Message& message, std::string& frame);

/** The first odometry of a rawlog: the observations of one label, or the motions of
 *  CActionCollections up to the observation that comes next. */
class RawlogOdometry {
 public:
    /** Label, or "actions"; nothing before the first sample. */
    const std::optional<std::string>& name() const { return name_; }

    void add(const mrpt::obs::CObservation& observation, double stamp_s);
    void add(const mrpt::obs::CActionCollection& actions);

    std::vector<OdometrySample> take() { return std::exchange(samples_, {}); }

 private:
    bool isChosen(const std::string& name);

    std::optional<std::string> name_;
    std::vector<OdometrySample> samples_;
    Eigen::Isometry3d moved_ = Eigen::Isometry3d::Identity();  //!< by all actions
    bool hasMoved_ = false;  //!< an action waits for the observation after it
};
}  // namespace delio::io
