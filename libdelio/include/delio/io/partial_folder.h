#pragma once
#include <filesystem>
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
}  // namespace delio::io
