#include "delio/io/target_folder.h"

#include "delio/core/error.h"

namespace delio::io {
namespace fs = std::filesystem;

TargetFolder::TargetFolder(const fs::path& path) : path_(path) {
    std::error_code fault;
    if (fs::exists(path, fault) && !fs::is_directory(path, fault))
        throw Error("'" + path.string() + "' exists and is no folder; choose another name");
    made_ = fs::create_directories(path, fault);
    if (fault) throw Error("cannot make the folder '" + path.string() + "': " + fault.message());
    lock_.emplace(path.string());
}

TargetFolder::~TargetFolder() {
    lock_.reset();
    std::error_code ignored;
    if (made_) fs::remove(path_, ignored);  // only an empty one
}
}  // namespace delio::io
