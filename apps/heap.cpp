#include "heap.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace delio {
namespace {
constexpr int kHeap = 192 << 20;  // of which memory is taken as it is written to

/** Lets the heap's end grow, in large pages. */
void growInLargePages() {
    constexpr std::uintptr_t kPage = 2 << 20;
    const auto end = [] { return reinterpret_cast<std::uintptr_t>(sbrk(0)); };
    const std::uintptr_t before = end();
    void* volatile any = std::malloc(kPage);  // volatile: is not left out
    std::free(any);
    const std::uintptr_t from = (before + kPage - 1) / kPage * kPage, to = end() / kPage * kPage;
    // Where the system does not know of such pages it says so, and all else is the same.
    if (to > from) madvise(reinterpret_cast<void*>(from), to - from, MADV_HUGEPAGE);
}
}  // namespace

void prepareHeap() {
    // What maps had goes back to the system when they are dropped: their blocks lie apart.
    mallopt(M_MMAP_THRESHOLD, 8 << 20);
    mallopt(M_ARENA_MAX, 1);  // the heap is every thread's
    mallopt(M_TRIM_THRESHOLD, 2 * kHeap);
    mallopt(M_TOP_PAD, kHeap);
    growInLargePages();
    mallopt(M_TOP_PAD, 16 << 20);
}
}  // namespace delio
