#pragma once
#include <filesystem>
#include <string>

namespace delio::io {
/** While it lives no other process can have one of the same output. What is locked is a folder
 *  itself; for a file it is a file `.partial-NAME.lock` beside it, which goes at the end. The
 *  system lifts the lock when a process dies in any way; the file of one that was killed stays
 *  behind and does no harm. On file systems that know no locks there is none. */
class OutputLock {
 public:
    /** Throws Error if another program has it, or no file can be made there. */
    explicit OutputLock(const std::string& output);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

 private:
    bool isStillThere() const;

    std::filesystem::path path_;  //!< of what is locked
    bool own_;                    //!< it was made for this
    int file_ = -1;
};
}  // namespace delio::io
