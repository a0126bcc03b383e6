#include "delio/scan/voxel_table.h"

namespace delio::scan {
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
}  // namespace delio::scan
