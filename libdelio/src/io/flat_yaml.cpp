#include "flat_yaml.h"

#include <sstream>

#include "delio/error.h"

namespace delio::io {
namespace {
std::string trimmed(const std::string& text) {
    const char* const kSpaces = " \t\r";
    const auto from = text.find_first_not_of(kSpaces);
    return from == std::string::npos ? ""
                                     : text.substr(from, text.find_last_not_of(kSpaces) - from + 1);
}

bool isNothing(const std::string& text) { return text.empty() || text[0] == '#'; }

/** What stands between the quotes that `text` begins with; after them only a comment may follow. */
std::string unquoted(const std::string& text) {
    const char quote = text[0];
    std::string value;
    for (std::size_t i = 1; i < text.size(); ++i) {
        const char next = i + 1 < text.size() ? text[i + 1] : '\0';
        if (text[i] == quote && !(quote == '\'' && next == quote)) {
            if (!isNothing(trimmed(text.substr(i + 1)))) break;
            return value;
        }
        const bool escape = quote == '"' && text[i] == '\\';
        if (escape || text[i] == quote) ++i;
        if (i == text.size()) break;
        value += escape && next == 'n' ? '\n' : escape && next == 't' ? '\t' : text[i];
    }
    throw Error("the quotes of " + text + " do not end");
}

std::string valueOf(const std::string& text) {
    if (isNothing(text)) return "";
    if (text[0] == '"' || text[0] == '\'') return unquoted(text);
    if (std::string("[]{}&*!|>%@`").find(text[0]) != std::string::npos)
        throw Error("'" + text + "' is no plain value; put it into quotes");
    return trimmed(text.substr(0, text.find(" #")));
}
}  // namespace

std::map<std::string, std::string> readFlatYaml(const std::string& text) {
    std::map<std::string, std::string> values;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        line = trimmed(line);
        if (isNothing(line) || line == "---") continue;
        const auto colon = line.find(": ");
        const bool bare = colon == std::string::npos && line.back() == ':';
        if (colon == std::string::npos && !bare)
            throw Error("'" + line + "' is no 'key: value' line");
        const std::string key = bare ? line.substr(0, line.size() - 1) : line.substr(0, colon);
        const std::string value = bare ? "" : valueOf(trimmed(line.substr(colon + 2)));
        if (!values.emplace(key, value).second) throw Error("the key '" + key + "' is there twice");
    }
    if (values.empty()) throw Error("it holds no 'key: value' lines");
    return values;
}

std::string quotedForYaml(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') quoted += '\\';
        if (c == '\n')
            quoted += "\\n";
        else if (c == '\t')
            quoted += "\\t";
        else
            quoted += c;
    }
    return quoted + '"';
}
}  // namespace delio::io
