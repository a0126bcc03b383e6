#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace delio::io {
/** A private folder `.partial-XXXXXX` for what is not whole yet. Its name cannot be guessed and
 *  nobody else can look into it; what is written in it has the permissions that the user's umask
 *  gives. It goes at the end with all that is left in it. A process that is killed leaves it
 *  behind: nothing reads it, and it may be removed. */
class PartialFolder {
 public:
    /** For what is to come into `folder`. `output` is what is being written, for messages. It lies
     *  in `place`, a folder of the same file system (empty: in `folder`). Throws Error where it
     *  cannot be made. */
    PartialFolder(const std::filesystem::path& folder, std::string output,
                  const std::filesystem::path& place = {});
    ~PartialFolder();
    PartialFolder(const PartialFolder&) = delete;
    PartialFolder& operator=(const PartialFolder&) = delete;

    /** Where files are to be written. */
    const std::filesystem::path& path() const { return path_; }

    /** Moves the files and folders `names` (those within other folders, too: "a/b") into `folder`,
     *  in place of what is there; a name that is not in here is not there either afterwards. All of
     * it or, where that fails, nothing is done: Error. The first of `names` marks the whole: the
     * old one goes first and the new one comes last. So whoever looks in between, or after a kill,
     * finds no file of that name, not parts of two outputs; where it is one file only, the old one
     * or the new one. (The old ones of a killed process lie in a folder of this kind, too.) */
    void putInPlace(const std::vector<std::string>& names);

    /** A message about a file in here as one about the file that it was to become. */
    std::string asInPlace(std::string message) const;

 private:
    std::filesystem::path folder_, path_;
    std::string output_;
};

/** The folder that holds `path`: "." for a bare name. */
std::filesystem::path folderOf(const std::filesystem::path& path);

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

/** A folder to write into: made if it is not there, locked for others (OutputLock), and taken away
 *  again at the end if it was made here and nothing is in it. */
class TargetFolder {
 public:
    /** Throws Error if it is a file, cannot be made, or another program writes it. */
    explicit TargetFolder(const std::filesystem::path& path);
    ~TargetFolder();
    TargetFolder(const TargetFolder&) = delete;
    TargetFolder& operator=(const TargetFolder&) = delete;

 private:
    std::filesystem::path path_;
    bool made_ = false;
    std::optional<OutputLock> lock_;
};
}  // namespace delio::io
