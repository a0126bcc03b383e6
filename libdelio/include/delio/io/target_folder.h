#pragma once
#include <filesystem>
#include <optional>

#include "delio/io/output_lock.h"

namespace delio::io {
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
