#pragma once
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace delio::io {
/** Private temporary folder `.partial-XXXXXX` for unfinished output. Its name is random and only
 *  the user can open it; files in it follow the user's umask. It is removed with its content at the
 *  end. A killed process leaves it; nothing reads it, and it may be deleted. */
class PartialFolder {
 public:
    /** For output to `folder`. `output` names the output in messages. It lies in `place`, a folder
     *  of the same file system (empty: in `folder`). Throws Error where it cannot be made. */
    PartialFolder(const std::filesystem::path& folder, std::string output,
                  const std::filesystem::path& place = {});
    ~PartialFolder();
    PartialFolder(const PartialFolder&) = delete;
    PartialFolder& operator=(const PartialFolder&) = delete;

    /** Folder to write to. */
    const std::filesystem::path& path() const { return path_; }

    /** Moves the files and folders `names` (those within other folders, too: "a/b") into `folder`,
     *  replacing existing ones; names that do not exist here are removed there. Moves all or, if
     *  that fails, none, and throws Error. The first of `names` marks completeness: the old one is
     *  removed first, the new one comes last. So between these moments, or after a kill, there is
     *  no file of that name, but never a mix of two outputs; a single file is either the old or the
     *  new one. (Old files of a killed process are in a folder of this kind.) */
    void putInPlace(const std::vector<std::string>& names);

    /** Replaces this folder's path in a message by the final one. */
    std::string asInPlace(std::string message) const;

 private:
    std::filesystem::path folder_, path_;
    std::string output_;
};

/** The folder that holds `path`: "." for a bare name. */
std::filesystem::path folderOf(const std::filesystem::path& path);

/** Lock on an output against other processes. Folders are locked directly; for a file,
 *  `.partial-NAME.lock` next to it is locked and removed at the end. The system releases the lock
 *  when the process ends; a killed process leaves a harmless lock file. File systems without locks
 *  are not protected. */
class OutputLock {
 public:
    /** Throws Error if another program holds the lock, or the lock file cannot be created. */
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

/** Output folder: created if needed, locked (OutputLock), and removed at the end if it was created
 *  here and is empty. */
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

/** Lets `write` fill a file of the same name in a PartialFolder beside `path`, then renames it to
 *  `path`: the file at `path` is always complete. If `write` throws, returns false or the disk is
 *  full, no file remains, and Error names the path. */
void replaceFile(const std::string& path, const std::function<bool(const std::string&)>& write);

/** The same for text: `write` gets a stream in the "C" locale. */
void replaceTextFile(const std::string& path, const std::function<void(std::ostream&)>& write);

/** Flushes a file, or a folder's entries, to disk (fsync). Throws Error if that fails. */
void putOnDisk(const std::string& path);
}  // namespace delio::io
