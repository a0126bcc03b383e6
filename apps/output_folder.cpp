#include "output_folder.h"

#include <filesystem>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output_folder.h"
#include "delio/run/keeper.h"

namespace delio {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& folder, bool force, bool resume) : folder_(folder) {
    const bool isUnfinished = run::Keeper(folder, "").hasState();
    if (isUnfinished && !force && !resume)
        throw Error("'" + folder +
                    "' holds a run that was ended before its time: go on with it by --resume, or "
                    "begin anew by --force");
    std::error_code fault;
    if (!isUnfinished && !fs::is_empty(folder, fault)) cli::refuseExisting(folder, force);
    const io::PartialFolder probe(folder, folder);
}
}  // namespace delio
