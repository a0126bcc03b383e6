#pragma once
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "command.h"

namespace delio::test {
inline std::vector<std::string> helpLinesOf(const std::string& tool) {
    std::istringstream help(runTool(tool, {"--help"}).out);
    std::vector<std::string> lines;
    for (std::string line; std::getline(help, line);) lines.push_back(line);
    return lines;
}

/** A line of Options. */
struct HelpOption {
    std::string flag, name, value;  //!< "-i", "--input", "IN"; what it has not is empty
    std::string text;               //!< all that is said of it, in one line
    bool isRequired() const { return text.rfind("(required)", 0) == 0; }
};

inline std::vector<HelpOption> helpOptionsOf(const std::string& tool) {
    static const std::regex shape("  (?:(-.), |    )(--[a-z0-9-]+)(?:=(\\S+))?(?:  +(.*))?");
    static const std::regex more(" {26}(\\S.*)");
    std::vector<HelpOption> options;
    for (const auto& line : helpLinesOf(tool)) {
        std::smatch match;
        if (std::regex_match(line, match, shape)) {
            options.push_back({match[1], match[2], match[3], match[4]});
        } else if (!options.empty() && std::regex_match(line, match, more)) {
            auto& text = options.back().text;
            text += (text.empty() ? "" : " ") + match[1].str();
        } else if (!options.empty()) {
            break;  // another part
        }
    }
    return options;
}

/** The rows of a part, e.g. "Writes:", by what stands before their first two spaces. */
inline std::vector<std::string> helpNamesOf(const std::string& tool, const std::string& part) {
    static const std::regex row("  (\\S.*?)(?:  .*)?");
    std::vector<std::string> names;
    bool isIn = false;
    for (const auto& line : helpLinesOf(tool)) {
        std::smatch match;
        if (isIn && line.empty()) break;
        if (isIn && std::regex_match(line, match, row)) names.push_back(match[1]);
        isIn = isIn || line == part;
    }
    return names;
}
}  // namespace delio::test
