#include "overlap.h"

#include <filesystem>

#include "delio/core/error.h"
#include "delio/files/output.h"
#include "delio/mrpt/rawlog_writer.h"

namespace delio::cli {
namespace fs = std::filesystem;

namespace {
/** Target of a path after following links. */
std::string realPath(const fs::path& path) {
    std::error_code fault;
    const fs::path real = fs::weakly_canonical(path, fault);
    return (fault ? fs::absolute(path) : real).string();
}

struct Input {
    std::string name, real;
};

/** The inputs that are there, and what links in those that are folders lead to. */
std::vector<Input> withLinks(const std::vector<std::string>& inputs) {
    std::vector<Input> all;
    for (const auto& input : inputs) {
        std::error_code fault;
        if (!fs::exists(input, fault)) continue;
        all.push_back({input, realPath(input)});
        constexpr auto kAsFarAsAllowed = fs::directory_options::skip_permission_denied;
        fs::recursive_directory_iterator entry(input, kAsFarAsAllowed, fault), end;
        for (; !fault && entry != end; entry.increment(fault))
            if (entry->is_symlink(fault))
                all.push_back({entry->path().string(), realPath(entry->path())});
    }
    return all;
}

/** `real` is where `output` leads to. */
void refuse(const Input& input, const std::string& output, const std::string& real) {
    std::error_code ignored;
    if (input.real == real || fs::equivalent(input.name, output, ignored))
        throw Error("'" + output + "' is also the input; choose another output");
    if (input.real.compare(0, real.size() + 1, real + "/") == 0)
        throw Error("'" + output + "' contains the input '" + input.name +
                    "'; choose another output");
}
}  // namespace

void refuseOverlap(const std::vector<std::string>& inputs,
                   const std::vector<std::string>& outputs) {
    const auto all = withLinks(inputs);
    for (const auto& output : outputs) {
        const std::string real = realPath(output);
        for (const auto& input : all) refuse(input, output, real);
    }
}

std::vector<std::string> filesOfRawlog(const std::string& path) {
    auto files = io::RawlogWriter::outputsOf(path);
    files.push_back((io::folderOf(path) / "Images").string());
    return files;
}
}  // namespace delio::cli
