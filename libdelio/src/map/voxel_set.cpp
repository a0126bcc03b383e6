#include "voxel_set.h"

#include "delio/scan/voxel_grid.h"

namespace delio::map {
bool VoxelSet::insert(const Eigen::Vector3d& point) {
    if (size_ == 0) return true;
    const Eigen::Array3d voxel = (point.array() / size_).floor();
    const Eigen::Array3d block = (voxel / 8).floor();
    const Eigen::Array3i inside = (voxel - 8 * block).cast<int>();
    const std::uint64_t key = scan::voxelKey(block, 1);
    if (!last_ || key != lastKey_) {
        last_ = &blocks_[key];  // stays where it is when others are added
        lastKey_ = key;
    }
    auto& layer = (*last_)[static_cast<std::size_t>(inside.z())];
    const std::uint64_t bit = std::uint64_t{1} << (8 * inside.y() + inside.x());
    if (layer & bit) return false;
    layer |= bit;
    return true;
}
}  // namespace delio::map
