#pragma once
#include <string>

namespace delio {
/** The folder for results is made at once, so that an unwritable one is found before the work is
 *  done; one that was made for nothing is taken away again. */
class OutputFolder {
 public:
    /** Throws Error where it cannot be written into, or is not empty and `force` is false. */
    OutputFolder(const std::string& folder, bool force);
    ~OutputFolder();
    OutputFolder(const OutputFolder&) = delete;
    OutputFolder& operator=(const OutputFolder&) = delete;

 private:
    std::string folder_;
    bool made_ = false;
};
}  // namespace delio
