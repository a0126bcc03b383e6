#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "make_scene.h"

namespace delio::test {
/** A scene as synth2rawlog makes it. */
std::unique_ptr<synth::Scene> sceneOf(const std::string& name, std::uint64_t seed,
                                      std::size_t scans, const std::string& trajectory = "");

/** KITTI's axes: x right, y down, z forward. */
Eigen::Isometry3d kittiAxes();

/** Poses of cam0 along an eight, at 8 m/s, twice round; in the middle of it the vehicle stands for
 *  3 s. What was measured jitters by `jitter_m`. */
void writeEight(const std::filesystem::path& file, double jitter_m);
constexpr double kEightRadius_m = 45;
}  // namespace delio::test
