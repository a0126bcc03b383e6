#pragma once
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace delio {
/** Gives back what largeMemory() gave. */
struct FreeMemory {
    void operator()(void* memory) const { std::free(memory); }  //!< free()
};
/** So many bytes, of which none is set; std::bad_alloc where there are not as many. Megabytes lie
 * in pages of 2 MB each, where the system has them: a table that is asked for places all over costs
 * a second access to memory for most of them where pages have 4 kB, and an interrupt for each page
 *  that it grows by. */
std::unique_ptr<void, FreeMemory> largeMemory(std::size_t bytes);

/** The same for containers. */
template <typename Value>
struct LargeAllocator {
    using value_type = Value;  //!< what there is room for
    LargeAllocator() = default;
    /** They all are the same. */
    template <typename Other>
    LargeAllocator(const LargeAllocator<Other>&) {}
    /** As largeMemory(). */
    Value* allocate(std::size_t values) {
        return static_cast<Value*>(largeMemory(values * sizeof(Value)).release());
    }
    /** What allocate() gave. */
    void deallocate(Value* memory, std::size_t) { FreeMemory()(memory); }

    friend bool operator==(const LargeAllocator&, const LargeAllocator&) { return true; }   //!< all
    friend bool operator!=(const LargeAllocator&, const LargeAllocator&) { return false; }  //!< no
};
}  // namespace delio
