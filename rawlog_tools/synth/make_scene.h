#pragma once
#include <Eigen/Geometry>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene.h"

namespace delio::synth {
struct SceneRequest {
    std::string name;
    std::uint64_t seed = 0;
    std::size_t scans = 0;   //!< the world reaches beyond them
    std::string trajectory;  //!< a file of KITTI poses of cam0 to drive along; empty: none
    Eigen::Isometry3d lidarToCam0 = Eigen::Isometry3d::Identity();
    /** Of the cars parked there; 0: none; nothing: as the world's seed has them. */
    std::optional<std::uint64_t> parkedSeed = {};
};

/** Values of --scene. */
std::vector<std::string> sceneNames();
/** True if this world supports --trajectory. */
bool takesTrajectory(const std::string& sceneName);
/** True if cars are parked in this world. */
bool hasParkedCars(const std::string& sceneName);
/** The name has to be one of sceneNames(). Throws Error for a trajectory that cannot be driven. */
std::unique_ptr<Scene> makeScene(const SceneRequest& request);
}  // namespace delio::synth
