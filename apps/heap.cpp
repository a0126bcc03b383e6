#include "heap.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <memory>

namespace delio {
namespace {
constexpr int kHeap = 192 << 20;  // of which memory is taken as it is written to

/** Lets the heap's end grow, in large pages. */
void growInLargePages() {
    constexpr std::size_t kPage = 2 << 20;
    const auto end = [] { return static_cast<char*>(sbrk(0)); };
    char* const before = end();
    void* volatile any = std::malloc(kPage);  // volatile: is not left out
    std::free(any);
    void* from = before;
    auto room = static_cast<std::size_t>(end() - before);
    // Where the system does not know of such pages it says so, and all else is the same.
    if (std::align(kPage, kPage, from, room)) madvise(from, room, MADV_HUGEPAGE);
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
