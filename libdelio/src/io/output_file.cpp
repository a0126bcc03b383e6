#include "delio/io/output_file.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>

#include "delio/core/error.h"

namespace delio::io {
namespace fs = std::filesystem;

void replaceFile(const std::string& path, const std::function<bool(const std::string&)>& write) {
    const fs::path target(path);
    const fs::path temporary = target.parent_path() / (".partial-" + target.filename().string());
    const auto giveUp = [&](const std::string& why) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        throw Error("cannot write '" + path + "': " + why);
    };
    try {
        if (!write(temporary.string())) giveUp("the disk is full or the folder is not writable");
    } catch (const Error&) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        throw;
    } catch (const std::exception& e) {
        giveUp(plainMessage(e));
    }
    std::error_code fault;
    fs::rename(temporary, target, fault);
    if (fault) giveUp(fault.message());
}

void replaceTextFile(const std::string& path, const std::function<void(std::ostream&)>& write) {
    replaceFile(path, [&](const std::string& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        if (!out) throw Error("cannot write '" + path + "': " + std::strerror(errno));
        out.imbue(std::locale::classic());
        write(out);
        out.close();
        return static_cast<bool>(out);
    });
}
}  // namespace delio::io
