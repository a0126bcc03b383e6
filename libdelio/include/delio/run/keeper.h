#pragma once
#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <string>

#include "delio/run/run.h"

namespace delio::run {
class RowFiles;

/** Keeps what a run has done, so that it can go on after anything has ended its process. The folder
 *  kFolder in that of its results has, as the drive goes on, the rows of scans.csv and of the
 *  odometry's trajectory, and the run's state: each second, or where a state takes long to write at
 *  such intervals that a twentieth of the time is spent on it. */
class Keeper {
 public:
    static constexpr const char* kFolder = "incomplete";  //!< in the folder of the results

    /** @param results the folder of the run's results
     *  @param drive what the scans are of, in a line: another run's are not gone on with */
    Keeper(const std::string& results, std::string drive);
    /** Takes away what was begun where there is no state yet. */
    ~Keeper();
    Keeper(const Keeper&) = delete;
    Keeper& operator=(const Keeper&) = delete;

    /** Where the run, too, puts aside what it goes on with: RunSettings::folder. */
    std::string folder() const { return folder_.string(); }
    /** A run was ended here that can be gone on with. */
    bool hasState() const;

    /** Before a run is made that does not go on with another: nothing of that stays. Error where
     *  there can be no folder. */
    void begin();
    /** Into a run of the same options and settings that has seen no scan. Error where the state is
     *  damaged, or of another run. */
    void resume(Run& run) const;

    /** After each scan. Error, once, where the disk is full: then nothing is kept any more, and
     * what was leaves its room to the results. */
    void add(const Run& run);
    /** After add(): the state as it is now. Error as there. */
    void keep(const Run& run);
    /** The run is over: there is nothing to go on with. */
    void remove();

 private:
    using Clock = std::chrono::steady_clock;

    void addRows(const Run& run);
    void writeState(const Run& run);
    template <typename Work>
    void unlessGivenUp(const Work& work);

    std::filesystem::path folder_, state_;
    std::string drive_;
    std::unique_ptr<RowFiles> files_;
    std::size_t rows_ = 0;  //!< in these
    bool begun_ = false, givenUp_ = false;
    Clock::time_point flushAt_ = Clock::now(), keepAt_ = Clock::now();
    std::future<void> writing_;  //!< of the state
};
}  // namespace delio::run
