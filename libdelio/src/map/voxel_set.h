#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace delio::map {
/** Which voxels of a grid are taken: a flat hash set of voxel indices, 8 bytes an entry. */
class VoxelSet {
 public:
    explicit VoxelSet(double voxelSize_m) : perMetre_(1 / voxelSize_m), slots_(1024, kFree) {}

    /** True if the voxel of this point was free; it is taken from now on. */
    bool take(double x, double y, double z) {
        if (2 * ++taken_ > slots_.size()) grow();
        const bool isNew = insert(key(x, y, z));
        if (!isNew) --taken_;
        return isNew;
    }

 private:
    static constexpr std::uint64_t kFree = std::numeric_limits<std::uint64_t>::max();

    // 21 bits an axis: two million voxels before indices repeat. The top bit stays 0, so that no
    // key is kFree.
    std::uint64_t key(double x, double y, double z) const {
        const auto index = [this](double v) {
            return static_cast<std::uint64_t>(
                       static_cast<std::int64_t>(std::floor(v * perMetre_))) &
                   0x1fffff;
        };
        return index(x) << 42 | index(y) << 21 | index(z);
    }

    bool insert(std::uint64_t key) {
        const std::size_t mask = slots_.size() - 1;
        std::uint64_t hash = key * 0x9e3779b97f4a7c15ULL;
        hash ^= hash >> 32;
        std::size_t at = hash & mask;
        while (slots_[at] != kFree) {
            if (slots_[at] == key) return false;
            at = (at + 1) & mask;
        }
        slots_[at] = key;
        return true;
    }

    void grow() {
        std::vector<std::uint64_t> old(2 * slots_.size(), kFree);
        old.swap(slots_);
        for (const auto key : old)
            if (key != kFree) insert(key);
    }

    double perMetre_;
    std::size_t taken_ = 0;
    std::vector<std::uint64_t> slots_;
};
}  // namespace delio::map
