#include "core/spread_threads.h"

#include <tbb/task_arena.h>
#include <algorithm>

namespace delio {
namespace {
cpu_set_t processorsOfThread() {
    cpu_set_t processors;
    CPU_ZERO(&processors);
    sched_getaffinity(0, sizeof(processors), &processors);
    return processors;
}

/** As they were when it was asked first: before any thread was bound. */
const cpu_set_t& processorsOfProgram() {
    static const cpu_set_t processors = processorsOfThread();
    return processors;
}

/** A thread that may not is slower, and nothing else. */
void bindTo(const cpu_set_t& processors) { sched_setaffinity(0, sizeof(processors), &processors); }
}  // namespace

SpreadThreads::SpreadThreads() {
    const cpu_set_t& all = processorsOfProgram();
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
               processors = static_cast<std::size_t>(CPU_COUNT(&all)),
               shares = std::min(threads, processors);
    if (shares < 2) return;
    shares_.resize(shares);
    for (cpu_set_t& share : shares_) CPU_ZERO(&share);
    for (std::size_t processor = 0, next = 0; processor < CPU_SETSIZE; ++processor)
        if (CPU_ISSET(processor, &all)) CPU_SET(processor, &shares_[next++ % shares]);
    bindTo(shares_.front());
    observe(true);
}

SpreadThreads::~SpreadThreads() {
    if (shares_.empty()) return;
    observe(false);
    runAnywhere();
}

void SpreadThreads::on_scheduler_entry(bool isWorker) {
    if (!isWorker) return;
    const auto thread = static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
    bindTo(shares_[thread % shares_.size()]);
}

void SpreadThreads::on_scheduler_exit(bool isWorker) {
    if (isWorker) runAnywhere();
}

void runAnywhere() { bindTo(processorsOfProgram()); }
}  // namespace delio
