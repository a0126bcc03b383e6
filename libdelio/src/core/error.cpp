#include "delio/core/error.h"

#include <filesystem>
#include <ios>
#include <new>

namespace delio {
namespace {
const char* const kNoMemory = "out of memory";

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/** yaml-cpp's "yaml-cpp: error at line 2, column 5: ...", from "line" on. */
std::string ofYaml(const std::string& what) {
    const std::string at = "error at ";
    const auto line = what.find(at);
    const auto where = line == std::string::npos ? what.size() : line + at.size();
    const auto end = what.find(": ", where);
    const std::string place =
        end == std::string::npos ? "" : what.substr(where, end - where) + ": ";
    if (holds(what, "bad conversion")) return place + "a value has the wrong type";
    const std::string key = "first invalid key: \"";
    const auto missing = what.find(key);
    if (missing != std::string::npos) {
        const auto name = missing + key.size();
        return "'" + what.substr(name, what.find('"', name) - name) + "' is missing";
    }
    if (holds(what, "bad file")) return "the file cannot be read";
    return place + (end == std::string::npos ? "not valid YAML" : what.substr(end + 2));
}
}  // namespace

std::string plainMessage(const std::exception& e) {
    const std::string what = e.what(), mark = "Message:";
    if (dynamic_cast<const Error*>(&e)) return what.substr(0, what.find('\n'));
    if (dynamic_cast<const std::bad_alloc*>(&e) || dynamic_cast<const std::length_error*>(&e))
        return kNoMemory;
    if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&e))
        return "'" + file->path1().string() + "': " + file->code().message();
    if (dynamic_cast<const std::ios_base::failure*>(&e)) return "the file cannot be read";
    if (what.compare(0, 8, "yaml-cpp") == 0 || what.compare(0, 12, "invalid node") == 0)
        return ofYaml(what.substr(0, what.find('\n')));
    // MRPT's own have a title and a mark; what others threw through it has the title only.
    const std::string title = "==== MRPT exception ====\n";
    auto from = what.find(mark);
    if (from != std::string::npos)
        from = what.find_first_not_of(' ', from + mark.size());
    else
        from = what.compare(0, title.size(), title) == 0 ? title.size() : 0;
    std::string message = what.substr(from, what.find('\n', from) - from);
    if (holds(message, "std::bad_alloc")) return kNoMemory;
    if (holds(message, "Assert condition failed") || message.compare(0, 6, "ASSERT") == 0)
        return "the file is damaged or of an unknown kind";
    return message;
}
}  // namespace delio
