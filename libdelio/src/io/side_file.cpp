#include "side_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "delio/core/error.h"

namespace delio::io {
SideFile sideFile(const std::string& path) {
    SideFile file{path, ""};
    if (!std::filesystem::exists(path)) return file;
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || in.bad())
        throw Error("cannot read '" + path + "': reading failed (is it a folder?)");
    file.text = text.str();
    return file;
}
}  // namespace delio::io
