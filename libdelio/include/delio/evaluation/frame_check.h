#pragma once
#include <Eigen/Geometry>

#include <vector>

namespace delio::evaluation {
/** Do the two trajectories belong to the same moving frame? LiDAR: x forward, y left, z up.
 *  Camera: z forward, x right, y down. */
enum class FrameMismatch {
    none,
    lidarAgainstCamera,  //!< estimate's axes are a LiDAR's, the reference's a camera's
    cameraAgainstLidar,  //!< the reverse, or an estimate turned from LiDAR to camera twice
    unknown              //!< the path is too short to tell
};

/** Compares the directions in which the moving frames travel, metre by metre (of paths below 6 m a
 *  sixth of the path, at least 0.2 m). A mismatch is reported only where the directions disagree as
 *  they stand (mean cosine below 0.5) and agree after the axes are swapped (above 0.9): a bad
 *  estimate is no mismatch. `unknown`: there are fewer than three such steps, and they do not
 *  agree as they stand. Same count of poses in both. */
FrameMismatch findFrameMismatch(const std::vector<Eigen::Isometry3d>& reference,
                                const std::vector<Eigen::Isometry3d>& estimate);

/** True if the moving frame travels along its own z, as a camera does, rather than along x. */
bool movesAlongZ(const std::vector<Eigen::Isometry3d>& poses);
}  // namespace delio::evaluation
