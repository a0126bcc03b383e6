#include "core/voxel_table.h"

#include <algorithm>
#include <cmath>

#include "core/voxel_grid.h"

namespace delio {
std::uint32_t VoxelIndex::insertNew(std::uint64_t key) {
    if (2 * (size_ + 1) > slots_.size()) rehash(shift_ - 1);
    const std::size_t slot = slotOf(key);
    slots_[slot] = {key, static_cast<std::uint32_t>(size_++)};
    return slots_[slot].number;
}

void VoxelIndex::erase(std::uint64_t key, std::uint64_t last) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t free = slotOf(key);
    slots_[slotOf(last)].number = slots_[free].number;
    // What lies behind goes ahead where it was passed on from here: no run of slots may be broken.
    for (std::size_t i = (free + 1) & mask; slots_[i].number != kNone; i = (i + 1) & mask) {
        const std::size_t passed = (i - firstSlotOf(slots_[i].key)) & mask;
        if (passed < ((i - free) & mask)) continue;
        slots_[free] = slots_[i];
        free = i;
    }
    slots_[free] = {};
    --size_;
}

void VoxelIndex::reserve(std::size_t keys) {
    unsigned shift = shift_;
    while (2 * keys > std::size_t{1} << (64 - shift)) --shift;
    if (shift != shift_) rehash(shift);
}

/** So many slots that at least every second one stays free: runs of taken ones are short. */
void VoxelIndex::rehash(unsigned shift) {
    const Slots before = std::exchange(slots_, Slots(std::size_t{1} << (64 - shift)));
    shift_ = shift;
    for (const Slot& taken : before)
        if (taken.number != kNone) slots_[slotOf(taken.key)] = taken;
}

VoxelBall::VoxelBall(const Eigen::Vector3d& centre, double radius, double size, unsigned levels)
    : centre_(voxelKey(centre, size)), half_(std::ldexp(0.5, static_cast<int>(levels))) {
    // From the corner of the voxel that the centre is in to the middle of the other one: the centre
    // may be an edge of the smallest farther along each axis, and so may rounding.
    const double reach = radius / size - std::sqrt(3.0) * (half_ + 1.01);
    squared_ = std::pow(std::max(reach, 0.0), 2);
}

bool VoxelBall::holds(std::uint64_t key) const {
    constexpr std::int64_t kHalf = 1 << 20;  // see voxelKey()
    const auto squaredAlong = [&](unsigned shift) {
        const auto part = static_cast<std::int64_t>((key >> shift) - (centre_ >> shift));
        const std::int64_t steps = ((part + kHalf) & (2 * kHalf - 1)) - kHalf;
        const double away = static_cast<double>(steps) + half_;
        return away * away;
    };
    return squaredAlong(42) + squaredAlong(21) + squaredAlong(0) < squared_;
}
}  // namespace delio
