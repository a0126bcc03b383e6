#include "output_folder.h"

#include <filesystem>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output.h"

namespace delio {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& folder, bool force) : folder_(folder) {
    std::error_code fault;
    if (!fs::is_empty(folder, fault)) cli::refuseExisting(folder, force);
    const io::PartialFolder probe(folder, folder);
}
}  // namespace delio
