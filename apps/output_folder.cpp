#include "output_folder.h"

#include <filesystem>
#include <fstream>

#include "cli.h"
#include "delio/core/error.h"

namespace delio {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& folder, bool force) : folder_(folder) {
    std::error_code fault;
    if (fs::exists(folder) && !fs::is_directory(folder))
        throw Error("'" + folder + "' exists and is no folder; choose another name");
    if (fs::exists(folder) && !fs::is_empty(folder, fault)) cli::refuseExisting(folder, force);
    made_ = fs::create_directories(folder, fault);
    const fs::path probe = fs::path(folder) / ".partial-probe";
    const bool writable = !fault && std::ofstream(probe).put('x').good();
    fs::remove(probe, fault);
    if (!writable) throw Error("cannot write into the folder '" + folder + "'");
}

OutputFolder::~OutputFolder() {
    std::error_code ignored;
    if (made_) fs::remove(folder_, ignored);  // only an empty one
}
}  // namespace delio
