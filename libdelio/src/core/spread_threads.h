#pragma once
#include <sched.h>
#include <tbb/task_scheduler_observer.h>

#include <vector>

namespace delio {
/** While it lives, the threads that compute for the one that made it stay on processors of their
 *  own. Otherwise Linux may keep two of them on one processor while another one is idle: it does so
 *  where they wait for most of the time, as between the scans of a live sensor. */
class SpreadThreads : public tbb::task_scheduler_observer {
 public:
    SpreadThreads();
    ~SpreadThreads() override;
    SpreadThreads(const SpreadThreads&) = delete;
    SpreadThreads& operator=(const SpreadThreads&) = delete;

    void on_scheduler_entry(bool isWorker) override;
    void on_scheduler_exit(bool isWorker) override;

 private:
    std::vector<cpu_set_t> shares_;  //!< of the processors; empty: there is one, or one thread
};

/** Lets the calling thread run on all processors of the program, wherever the thread that started
 *  it stays. */
void runAnywhere();
}  // namespace delio
