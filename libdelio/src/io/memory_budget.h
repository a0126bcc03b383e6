#pragma once
#include <cstdint>

namespace delio::io {
/** While one lives the process gets only so much more memory than it has: who asks for more gets a
 *  std::bad_alloc. For what MRPT reads: it makes room for what a file claims in hundreds of places
 *  before it looks whether the file has it. The limit is the process's own (RLIMIT_DATA), so one
 *  object at a time is read under it, and others wait. It does nothing under the address
 *  and thread sanitizers, which end the process instead. */
class MemoryBudget {
 public:
    explicit MemoryBudget(std::uint64_t bytes);
    ~MemoryBudget();
    MemoryBudget(const MemoryBudget&) = delete;
    MemoryBudget& operator=(const MemoryBudget&) = delete;

    /** For one object of a stream of them: far more than a scan takes. */
    static constexpr std::uint64_t kOfOneScan = 256ULL << 20;

    /** For all of a file of this size, compressed or not: MRPT's objects take a few times the bytes
     *  that they are written with. */
    static constexpr std::uint64_t ofWholeFile(std::uint64_t size) {
        return (128ULL << 20) + 64 * size;
    }
};
}  // namespace delio::io
