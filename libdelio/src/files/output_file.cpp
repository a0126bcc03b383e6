#include "delio/files/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>

#include "delio/core/error.h"
#include "delio/files/output_folder.h"

namespace delio::io {
namespace fs = std::filesystem;

void replaceFile(const std::string& path, const std::function<bool(const std::string&)>& write) {
    const fs::path target(path);
    const PartialFolder partial(folderOf(target), path);
    const fs::path temporary = partial.path() / target.filename();
    std::error_code fault;
    try {
        if (!write(temporary.string()))
            throw Error("cannot write '" + path +
                        "': the disk is full or the folder is not writable");
        fs::rename(temporary, target, fault);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& e) {
        throw Error("cannot write '" + path + "': " + plainMessage(e));
    }
    if (fault) throw Error("cannot write '" + path + "': " + fault.message());
}

void putOnDisk(const std::string& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool done = file >= 0 && fsync(file) == 0;
    const int fault = errno;
    if (file >= 0) close(file);
    // Not every file system can say that of a folder.
    if (!done && fault != EINVAL)
        throw Error("cannot write '" + path + "': " + std::strerror(fault));
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
