#pragma once
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

namespace delio::test {
/** While it lives, the process may map only so much more memory: who wants more gets a
 *  std::bad_alloc. */
class MemoryLimit {
 public:
    explicit MemoryLimit(std::size_t megabytes) {
        getrlimit(RLIMIT_AS, &before_);
        if (!works()) return;
        rlimit limit = before_;
        std::size_t pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        limit.rlim_cur =
            pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + (megabytes << 20);
        setrlimit(RLIMIT_AS, &limit);
    }
    ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

    /** Not under the address and thread sanitizers, which end the process instead. */
    static constexpr bool works() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
        return false;
#else
        return true;
#endif
    }

 private:
    rlimit before_{};
};
}  // namespace delio::test
