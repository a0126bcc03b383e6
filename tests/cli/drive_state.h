#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "test_data.h"

namespace delio::test {
/** What a folder holds, but for what a killed process may leave: names and contents. */
using State = std::map<std::string, std::string>;

inline State stateOf(const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    State state;
    for (auto entry = fs::recursive_directory_iterator(folder);
         entry != fs::recursive_directory_iterator(); ++entry) {
        if (entry->path().filename().string().rfind(".partial-", 0) == 0) {
            entry.disable_recursion_pending();
            continue;
        }
        state[fs::relative(entry->path(), folder)] =
            entry->is_regular_file() ? readText(entry->path()) : "";
    }
    return state;
}

/** Whether a process has left something behind. */
inline bool hasLeftovers(const std::filesystem::path& folder) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().filename().string().rfind(".partial-", 0) == 0) return true;
    return false;
}

/** `to` becomes a copy of `from`, of the same files: no tool writes into one that is there. */
inline void restore(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::filesystem::remove_all(to);
    std::filesystem::copy(from, to,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::create_hard_links);
}
}  // namespace delio::test
