#pragma once
#include <Eigen/Geometry>

#include <string>
#include <vector>

#include "motion.h"
#include "path.h"

namespace delio::synth {
/** A given trajectory: at scan i the vehicle is where pose i says, seen from above. What the poses
 *  jitter is smoothed away (a few centimetres); heights, pitch and roll are dropped, as the ground
 *  of the made-up world gives them. */
class Recording : public Motion {
 public:
    /** Reads KITTI's poses of cam0; `lidarToCam0` brings them to the LiDAR. Throws Error where the
     *  file is not readable, or no vehicle can have driven like that. */
    Recording(const std::string& file, const Eigen::Isometry3d& lidarToCam0);

    PlanPose at(double time_s) const override;
    double duration_s() const override;
    std::size_t poses() const { return plan_.size(); }
    /** The smooth curve along which the poses lie, with a margin before and behind. */
    const Path& path() const { return path_; }

 private:
    void placeOnPath();

    std::vector<PlanPose> plan_;  // a scan's period apart
    Path path_;
};
}  // namespace delio::synth
