#include "side_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "delio/core/error.h"

namespace delio::io {
bool isFileThere(const std::string& path) {
    const auto status = std::filesystem::status(path);
    if (!std::filesystem::exists(status)) return false;
    if (!std::filesystem::is_regular_file(status))
        throw Error("cannot read '" + path + "': it is no file (a folder, a pipe or a device?)");
    return true;
}

SideFile sideFile(const std::string& path) {
    SideFile file{path, ""};
    if (!isFileThere(path)) return file;
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || in.bad()) throw Error("cannot read '" + path + "': reading failed");
    file.text = text.str();
    return file;
}
}  // namespace delio::io
