#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace delio::scan {
/** Which voxels lie in a ball for certain: told by their keys alone, which lie closely packed, as a
 *  map is swept of what is far. */
class VoxelBall {
 public:
    /** `size`: edge of the smallest voxels; asked for are those 2^levels times as large. */
    VoxelBall(const Eigen::Vector3d& centre, double radius, double size, unsigned levels = 0);

    /** False where a part of the voxel may lie outside. */
    bool holds(std::uint64_t key) const;

 private:
    std::uint64_t centre_;
    double half_;     //!< edge of a voxel, in the smallest ones
    double squared_;  //!< of how far a voxel's middle may be, likewise
};
}  // namespace delio::scan
