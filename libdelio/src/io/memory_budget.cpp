#include "memory_budget.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <mutex>

namespace delio::io {
namespace {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kWorks = false;
#else
constexpr bool kWorks = true;
#endif

/** The one limit that the process has, and who holds it. */
struct Limit {
    std::recursive_mutex mutex;
    unsigned holders = 0;
    rlimit before{};
};

Limit& theLimit() {
    static Limit limit;
    return limit;
}

/** What the process has now, as RLIMIT_DATA counts it, or a little more. */
std::uint64_t usedBytes() {
    std::ifstream statm("/proc/self/statm");
    std::uint64_t size = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
    statm >> size >> resident >> shared >> text >> library >> data;
    return statm ? data * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}
}  // namespace

MemoryBudget::MemoryBudget(std::uint64_t bytes) {
    Limit& limit = theLimit();
    limit.mutex.lock();
    if (!kWorks || limit.holders++ > 0) return;
    getrlimit(RLIMIT_DATA, &limit.before);
    const std::uint64_t used = usedBytes();
    if (used == 0) return;  // there is no /proc: better no limit than one that is wrong
    rlimit lower = limit.before;
    lower.rlim_cur = std::min<rlim_t>(lower.rlim_cur, used + bytes);
    setrlimit(RLIMIT_DATA, &lower);
}

MemoryBudget::~MemoryBudget() {
    Limit& limit = theLimit();
    if (kWorks && --limit.holders == 0) setrlimit(RLIMIT_DATA, &limit.before);
    limit.mutex.unlock();
}
}  // namespace delio::io
