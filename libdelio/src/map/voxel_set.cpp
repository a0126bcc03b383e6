#include "voxel_set.h"

namespace delio::map {
namespace {
/** std::floor() would be a call for each coordinate. */
std::int64_t roundedDown(double v) {
    const auto whole = static_cast<std::int64_t>(v);
    return whole - (v < static_cast<double>(whole));
}
}  // namespace

VoxelSet::Place VoxelSet::placeOf(const Eigen::Vector3d& point) const {
    const std::int64_t x = roundedDown(point.x() / size_), y = roundedDown(point.y() / size_),
                       z = roundedDown(point.z() / size_);
    // 21 bits an axis: blocks within a million to either side of the origin do not mix.
    const auto part = [](std::int64_t v) {
        return static_cast<std::uint64_t>(v >> 3) & ((1U << 21) - 1);
    };
    return {part(x) << 42 | part(y) << 21 | part(z), static_cast<std::size_t>(z & 7),
            std::uint64_t{1} << (8 * (y & 7) + (x & 7))};
}

bool VoxelSet::insert(const Eigen::Vector3d& point) {
    if (size_ == 0) return true;
    const Place place = placeOf(point);
    if (!last_ || place.block != lastKey_) {
        last_ = &blocks_[place.block];  // stays where it is when others are added
        lastKey_ = place.block;
    }
    auto& layer = (*last_)[place.layer];
    if (layer & place.bit) return false;
    layer |= place.bit;
    return true;
}
}  // namespace delio::map
