#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <unordered_map>

namespace delio::map {
/** Which voxels are taken. Eight times eight times eight of them share 64 bytes: a map of surfaces
 *  needs about two bytes a voxel, and points that follow each other meet in one block. */
class VoxelSet {
 public:
    /** @param size edge of a voxel; 0: every point has a voxel of its own */
    explicit VoxelSet(double size) : size_(size) {}
    VoxelSet(const VoxelSet&) = delete;
    VoxelSet& operator=(const VoxelSet&) = delete;
    VoxelSet(VoxelSet&&) = default;
    VoxelSet& operator=(VoxelSet&&) = default;

    /** Takes the point's voxel; false if it was taken already. */
    bool insert(const Eigen::Vector3d& point);

 private:
    using Block = std::array<std::uint64_t, 8>;  //!< a layer of 8 x 8 voxels a word
    struct Place {
        std::uint64_t block;
        std::size_t layer;
        std::uint64_t bit;
    };
    Place placeOf(const Eigen::Vector3d& point) const;

    double size_;
    std::unordered_map<std::uint64_t, Block> blocks_;
    std::uint64_t lastKey_ = 0;
    Block* last_ = nullptr;
};
}  // namespace delio::map
