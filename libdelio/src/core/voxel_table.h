#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/chunked.h"

namespace delio {
/** Numbers the keys of voxels from 0 in the order in which they come. An open-addressing hash table
 *  with linear probing: a look-up mostly touches one place in memory, where std::unordered_map
 *  follows pointers. */
class VoxelIndex {
 public:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};  //!< no number

    std::size_t size() const { return size_; }  //!< keys

    /** The key's number; kNone where it has none. */
    std::uint32_t find(std::uint64_t key) const { return slots_[slotOf(key)].number; }

    /** The key's number: that of a new key is the size before. */
    std::uint32_t insert(std::uint64_t key) {
        const Slot& slot = slots_[slotOf(key)];
        return slot.number != kNone ? slot.number : insertNew(key);
    }

    /** Takes a key that it has out. `last`, the key with the last number, gets the number that is
     *  free now. */
    void erase(std::uint64_t key, std::uint64_t last);

    /** Prefetches a key, so that the memory accesses of many keys overlap. */
    void prefetch(std::uint64_t key) const { __builtin_prefetch(&slots_[firstSlotOf(key)]); }

    /** Drops everything. */
    void clear() { *this = VoxelIndex(); }
    /** Makes room for so many keys. */
    void reserve(std::size_t keys);

 private:
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t number = kNone;
    };
    std::size_t firstSlotOf(std::uint64_t key) const {
        constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15;  // spreads neighbours
        return (key * kGolden) >> shift_;
    }
    /** Slot of the key, or the free slot for it. There is always a free slot. */
    std::size_t slotOf(std::uint64_t key) const {
        std::size_t slot = firstSlotOf(key);
        while (slots_[slot].number != kNone && slots_[slot].key != key)
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    std::uint32_t insertNew(std::uint64_t key);
    void rehash(unsigned shift);

    unsigned shift_ = 60;  //!< 64 less the binary logarithm of the slots
    using Slots = std::vector<Slot, LargeAllocator<Slot>>;
    Slots slots_ = Slots(16);
    std::size_t size_ = 0;
};

/** A map from voxels' keys to values, which lie by the thousand one behind the other in memory.
 *  Pointers are valid until values are erased. */
template <typename Value>
class VoxelTable {
 public:
    std::size_t size() const { return values_.size(); }  //!< values

    /** The number of the key's value; VoxelIndex::kNone if the key is missing. */
    std::uint32_t numberOf(std::uint64_t key) const { return index_.find(key); }

    /** Null if the key is missing. */
    const Value* find(std::uint64_t key) const {
        const std::uint32_t number = index_.find(key);
        return number == VoxelIndex::kNone ? nullptr : &values_[number];
    }

    /** The same, to be changed. */
    Value* find(std::uint64_t key) {
        const std::uint32_t number = index_.find(key);
        return number == VoxelIndex::kNone ? nullptr : &values_[number];
    }

    /** The number of the key's value, which is created if missing. */
    std::uint32_t insert(std::uint64_t key) {
        const std::uint32_t number = index_.insert(key);
        if (number == values_.size()) {
            values_.push_back({});
            keys_.push_back(key);
        }
        return number;
    }

    /** The same for many keys, with prefetching. */
    std::vector<std::uint32_t> insert(const std::vector<std::uint64_t>& keys) {
        std::vector<std::uint32_t> numbers(keys.size());
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (i + kAhead < keys.size()) index_.prefetch(keys[i + kAhead]);
            // Many points lie in the voxel of the one before.
            numbers[i] = i > 0 && keys[i] == keys[i - 1] ? numbers[i - 1] : insert(keys[i]);
        }
        return numbers;
    }

    /** Prefetches the key's value. */
    void prefetch(std::uint64_t key) const { index_.prefetch(key); }
    /** Prefetches the value of a number. */
    void prefetchValue(std::uint32_t number) const {
        constexpr std::size_t kLine = 64, kMost = 5 * kLine;  // frequently read members first
        const auto* const at = reinterpret_cast<const char*>(&values_[number]);
        for (std::size_t i = 0; i < std::min(kMost, sizeof(Value)); i += kLine)
            __builtin_prefetch(at + i);
    }

    /** Calls visit(i, value) for each number in turn, with prefetching. */
    template <typename Visit>
    void forEach(const std::vector<std::uint32_t>& numbers, const Visit& visit) {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (i + kAhead < numbers.size()) prefetchValue(numbers[i + kAhead]);
            visit(i, values_[numbers[i]]);
        }
    }

    /** The value with this number. */
    Value& operator[](std::uint32_t number) { return values_[number]; }
    /** The value with this number. */
    const Value& operator[](std::uint32_t number) const { return values_[number]; }

    /** Erases the values of which `isGone(key, value)`. The last one takes the place of each: then
     *  `moved(from, to)` is called with both its numbers. What stays is not touched, as most of a
     *  map does. */
    template <typename Predicate, typename Moved>
    void eraseIf(const Predicate& isGone, const Moved& moved) {
        for (std::size_t i = 0; i < keys_.size();) {
            if (!isGone(keys_[i], values_[i])) {
                ++i;
                continue;
            }
            const std::size_t last = keys_.size() - 1;
            index_.erase(keys_[i], keys_[last]);
            if (i != last) {
                values_[i] = std::move(values_[last]);
                keys_[i] = keys_[last];
                moved(static_cast<std::uint32_t>(last), static_cast<std::uint32_t>(i));
            }
            values_.resize(last);
            keys_.pop_back();
        }
    }

    /** Drops everything. */
    void clear() { *this = VoxelTable(); }

 private:
    static constexpr std::size_t kAhead = 16;

    VoxelIndex index_;
    Chunked<Value> values_;
    std::vector<std::uint64_t> keys_;  //!< of the values
};

/** Voxels that certainly lie in a ball, decided from their keys alone, to remove distant voxels
 *  from a map. */
class VoxelBall {
 public:
    /** `size`: edge of the smallest voxels; the voxels tested are 2^levels times as large. */
    VoxelBall(const Eigen::Vector3d& centre, double radius, double size, unsigned levels = 0);

    /** False where a part of the voxel may lie outside. */
    bool holds(std::uint64_t key) const;

 private:
    std::uint64_t centre_;
    double half_;     //!< edge of a voxel, in the smallest ones
    double squared_;  //!< of how far a voxel's middle may be, likewise
};
}  // namespace delio
