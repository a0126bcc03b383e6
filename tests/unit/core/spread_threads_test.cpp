#include "core/spread_threads.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <map>
#include <mutex>
#include <thread>

namespace {
using namespace delio;

cpu_set_t processors() {
    cpu_set_t set;
    CPU_ZERO(&set);
    EXPECT_EQ(sched_getaffinity(0, sizeof(set), &set), 0);
    return set;
}

/** Those of each thread of this one's arena. */
std::map<int, cpu_set_t> processorsOfThreads() {
    std::map<int, cpu_set_t> found;
    std::mutex mutex;
    tbb::parallel_for(0, 64, [&](int) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));  // time for the others to come
        const std::lock_guard lock(mutex);
        found[tbb::this_task_arena::current_thread_index()] = processors();
    });
    return found;
}

TEST(SpreadThreads, NoTwoShareAProcessor) {
    const cpu_set_t all = processors();
    std::map<int, cpu_set_t> found;
    {
        const SpreadThreads spread;
        found = processorsOfThreads();
        std::thread other([&] {
            runAnywhere();
            const cpu_set_t own = processors();
            EXPECT_TRUE(CPU_EQUAL(&own, &all));
        });
        other.join();
    }
    for (const auto& [one, its] : found) {
        EXPECT_GT(CPU_COUNT(&its), 0);
        if (CPU_COUNT(&all) > 1) {
            EXPECT_LT(CPU_COUNT(&its), CPU_COUNT(&all)) << one;
        }
        for (const auto& [another, theirs] : found) {
            if (one == another) continue;
            cpu_set_t both;
            CPU_AND(&both, &its, &theirs);
            EXPECT_EQ(CPU_COUNT(&both), 0) << one << " and " << another;
        }
    }
    const cpu_set_t after = processors();
    EXPECT_TRUE(CPU_EQUAL(&after, &all));
}

TEST(SpreadThreads, OneThreadStaysFree) {
    const cpu_set_t all = processors();
    tbb::task_arena(1).execute([&] {
        const SpreadThreads spread;
        const cpu_set_t during = processors();
        EXPECT_TRUE(CPU_EQUAL(&during, &all));
    });
}
}  // namespace
