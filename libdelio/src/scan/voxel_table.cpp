#include "delio/scan/voxel_table.h"

namespace delio::scan {
std::uint32_t VoxelIndex::insert(std::uint64_t key) {
    std::size_t slot = slotOf(key);
    if (slots_[slot].number != kNone) return slots_[slot].number;
    if (2 * (size_ + 1) > slots_.size()) {
        grow();
        slot = slotOf(key);
    }
    slots_[slot] = {key, static_cast<std::uint32_t>(size_++)};
    return slots_[slot].number;
}

void VoxelIndex::reserve(std::size_t keys) {
    while (2 * keys > slots_.size()) grow();
}

/** Twice as many slots: at least every second one stays free, so that runs of taken ones are short.
 */
void VoxelIndex::grow() {
    const std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(2 * slots_.size()));
    --shift_;
    for (const Slot& taken : before)
        if (taken.number != kNone) slots_[slotOf(taken.key)] = taken;
}
}  // namespace delio::scan
