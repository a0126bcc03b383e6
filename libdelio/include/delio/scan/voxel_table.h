#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "delio/core/chunked.h"

namespace delio::scan {
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
    std::uint32_t insert(std::uint64_t key);

    /** The key will be asked for soon: memory is slow, and many keys can be waited for at once. */
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
    /** Where the key is, or the free slot where it would be. There always is a free one. */
    std::size_t slotOf(std::uint64_t key) const {
        std::size_t slot = firstSlotOf(key);
        while (slots_[slot].number != kNone && slots_[slot].key != key)
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }
    void grow();

    unsigned shift_ = 60;  //!< 64 less the binary logarithm of the slots
    std::vector<Slot> slots_ = std::vector<Slot>(16);
    std::size_t size_ = 0;
};

/** A map from voxels' keys to values, which lie by the thousand one behind the other in memory.
 *  Pointers are valid until values are erased. */
template <typename Value>
class VoxelTable {
 public:
    std::size_t size() const { return values_.size(); }  //!< values

    /** The number of the key's value; VoxelIndex::kNone where there is none. */
    std::uint32_t numberOf(std::uint64_t key) const { return index_.find(key); }

    /** Null where there is none. */
    const Value* find(std::uint64_t key) const {
        const std::uint32_t number = index_.find(key);
        return number == VoxelIndex::kNone ? nullptr : &values_[number];
    }

    /** The same, to be changed. */
    Value* find(std::uint64_t key) {
        const std::uint32_t number = index_.find(key);
        return number == VoxelIndex::kNone ? nullptr : &values_[number];
    }

    /** The number of the key's value, which is made if there is none. */
    std::uint32_t insert(std::uint64_t key) {
        const std::uint32_t number = index_.insert(key);
        if (number == values_.size()) {
            values_.push_back({});
            keys_.push_back(key);
        }
        return number;
    }

    /** The value with this number. */
    Value& operator[](std::uint32_t number) { return values_[number]; }
    /** The value with this number. */
    const Value& operator[](std::uint32_t number) const { return values_[number]; }

    /** Soon insert(key) is called, or the number's value wanted. */
    void prefetch(std::uint64_t key) const { index_.prefetch(key); }
    /** See prefetch(). */
    void prefetchValue(std::uint32_t number) const { __builtin_prefetch(&values_[number]); }

    /** Gives the numbers, rising, of those that stay: they are numbered anew in this order. */
    template <typename Predicate>
    std::vector<std::uint32_t> eraseIf(const Predicate& isGone) {
        std::vector<std::uint32_t> staying;
        std::size_t kept = 0;
        index_.clear();
        index_.reserve(values_.size());
        for (std::size_t i = 0; i < values_.size(); ++i) {
            if (isGone(values_[i])) continue;
            index_.insert(keys_[i]);
            staying.push_back(static_cast<std::uint32_t>(i));
            if (kept != i) values_[kept] = std::move(values_[i]);
            keys_[kept++] = keys_[i];
        }
        values_.resize(kept);
        keys_.resize(kept);
        return staying;
    }

    /** Drops everything. */
    void clear() { *this = VoxelTable(); }

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(keys_, values_);
        if constexpr (Archive::is_loading::value) {
            index_.clear();
            index_.reserve(keys_.size());
            for (const std::uint64_t key : keys_) index_.insert(key);
        }
    }

 private:
    VoxelIndex index_;
    Chunked<Value> values_;
    std::vector<std::uint64_t> keys_;  //!< of the values
};
}  // namespace delio::scan
