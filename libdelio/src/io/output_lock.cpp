#include "delio/io/output_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "delio/core/error.h"
#include "delio/io/partial_folder.h"

namespace delio::io {
namespace fs = std::filesystem;

OutputLock::OutputLock(const std::string& output) : path_(output), own_(!fs::is_directory(output)) {
    if (own_) path_ = folderOf(output) / (".partial-" + path_.filename().string() + ".lock");
    do {
        if (file_ >= 0) close(file_);
        // Nothing is written: a file that somebody else has put there stays as it is. A pipe would
        // be waited for.
        constexpr int kHow = O_RDONLY | O_NONBLOCK | O_CLOEXEC;
        file_ = own_ ? open(path_.c_str(), kHow | O_CREAT | O_NOFOLLOW, 0666)
                     : open(path_.c_str(), kHow | O_DIRECTORY);
        if (file_ < 0) throw Error("cannot write '" + output + "': " + strerror(errno));
        struct stat opened {};
        if (own_ && (fstat(file_, &opened) != 0 || !S_ISREG(opened.st_mode))) {
            close(file_);
            throw Error("cannot write '" + output + "': '" + path_.string() +
                        "' is in the way, which is no file; remove it");
        }
        if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            close(file_);
            throw Error("'" + output +
                        "' is being written by another program; wait for it, or choose another "
                        "name");
        }
        // Its last owner may have removed the file between the two calls.
    } while (!isStillThere());
}

bool OutputLock::isStillThere() const {
    struct stat opened {
    }, there{};
    if (fstat(file_, &opened) != 0 || stat(path_.c_str(), &there) != 0) return false;
    return opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

OutputLock::~OutputLock() {
    if (own_) unlink(path_.c_str());
    close(file_);
}
}  // namespace delio::io
