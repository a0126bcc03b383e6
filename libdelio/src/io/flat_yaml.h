#pragma once
#include <map>
#include <string>

namespace delio::io {
/** Reads `key: value # comment` lines; values plain, 'quoted' or "quoted" with \\ \" \n \t. MRPT's
 *  YAML reader keeps what it read before a fault and goes on, and takes `0.2x` for a number.
 *  Throws Error for any other line, a key that is there twice, or a text without keys. */
std::map<std::string, std::string> readFlatYaml(const std::string& text);

/** `text` in double quotes, as readFlatYaml() and every YAML reader give it back. */
std::string quotedForYaml(const std::string& text);
}  // namespace delio::io
