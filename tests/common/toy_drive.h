#pragma once
#include <Eigen/Geometry>

#include <filesystem>
#include <string>
#include <vector>

namespace delio::test {
using Floats = std::vector<float>;

/** What a LiDAR of 64 rings, looking along x, sees at `position` (metres) in a street of blocks: x
 * y z intensity, ring by ring as KITTI has it. About 30 000 points, quick to make. */
Floats toyScan(const Eigen::Vector3d& position);

/** The `count` scans of a straight drive along x. */
std::vector<Floats> toyScans(std::size_t count, double step_m = 1);

/** `scans` as a KITTI odometry sequence: velodyne/, times.txt (0.1 s apart), calib.txt and
 *  poses.txt (cam0; the drive of toyScans()). */
void writeSequence(const std::filesystem::path& folder, const std::vector<Floats>& scans,
                   double step_m = 1);

void writeFloats(const std::filesystem::path& file, const Floats& values);

/** 7 as `000007.bin`. */
std::string scanName(std::size_t number);

/** Names of all that lies below `folder`, sorted. */
std::vector<std::string> namesIn(const std::filesystem::path& folder);

std::vector<std::string> linesOf(const std::string& text);
}  // namespace delio::test
