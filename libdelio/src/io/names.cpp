#include "names.h"

#include <algorithm>

namespace delio::io {
bool isFileName(const std::string& name) {
    return !name.empty() && name != "." && name != ".." &&
           std::none_of(name.begin(), name.end(),
                        [](const unsigned char c) { return c == '/' || c < 0x20 || c == 0x7F; });
}

bool staysInside(const std::filesystem::path& name) {
    return !name.is_absolute() && std::find(name.begin(), name.end(), "..") == name.end();
}
}  // namespace delio::io
