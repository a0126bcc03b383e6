#include "core/chunked.h"

#include <sys/mman.h>

namespace delio {
std::unique_ptr<void, FreeMemory> largeMemory(std::size_t bytes) {
    constexpr std::size_t kPage = 2 << 20, kLine = 64;
    const bool isLarge = bytes >= kPage;
    const std::size_t unit = isLarge ? kPage : kLine, whole = (bytes + unit - 1) / unit * unit;
    std::unique_ptr<void, FreeMemory> memory(std::aligned_alloc(unit, whole));
    if (!memory) throw std::bad_alloc();
    // Where the system does not know of such pages it has said so, and all else is the same.
    if (isLarge) madvise(memory.get(), whole, MADV_HUGEPAGE);
    return memory;
}
}  // namespace delio
