#include "delio/files/output.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <locale>
#include <new>
#include <utility>

#include "delio/core/error.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
bool isThere(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

bool isFolder(const fs::path& path) {
    std::error_code ignored;
    return fs::is_directory(fs::symlink_status(path, ignored));
}

/** Renames that can be taken back. */
class Moves {
 public:
    /** Does nothing where `from` is not there, or an earlier move has failed. */
    void move(const fs::path& from, const fs::path& to) {
        if (fault || !isThere(from)) return;
        fs::create_directories(to.parent_path(), fault);
        if (!fault) fs::rename(from, to, fault);
        if (!fault) done_.emplace_back(from, to);
    }
    /** False if something had to stay where it had been moved to. */
    bool takeBack() {
        bool whole = true;
        for (auto each = done_.rbegin(); each != done_.rend(); ++each) {
            std::error_code failed;
            fs::rename(each->second, each->first, failed);
            if (failed) whole = false;
            fs::remove(each->second.parent_path(), failed);  // an empty one, which was made for it
        }
        return whole;
    }
    std::error_code fault;

 private:
    std::vector<std::pair<fs::path, fs::path>> done_;
};
}  // namespace

fs::path folderOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

PartialFolder::PartialFolder(const fs::path& folder, std::string output, const fs::path& place)
    : folder_(folder), output_(std::move(output)) {
    std::string name = ((place.empty() ? folder : place) / ".partial-XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error("cannot write '" + output_ + "': " + strerror(errno));
    path_ = name;
}

PartialFolder::~PartialFolder() {
    try {
        std::error_code ignored;
        if (!path_.empty()) fs::remove_all(path_, ignored);
    } catch (const std::bad_alloc&) {
        // It stays: even to remove a folder takes memory.
    }
}

void PartialFolder::putInPlace(const std::vector<std::string>& names) {
    Moves moves;
    for (const auto& name : names)
        if (isFolder(folder_ / name) && isThere(path_ / name) && !isFolder(path_ / name))
            throw Error("cannot write '" + (folder_ / name).string() + "': a folder has this name");
    std::vector<std::string> concerned;
    for (const auto& name : names)
        if (isThere(folder_ / name) || isThere(path_ / name)) concerned.push_back(name);
    PartialFolder old(folder_, output_, path_.parent_path());
    // A file alone takes the place of the old one in one step.
    if (concerned.size() != 1 || !isThere(path_ / concerned[0]) || isFolder(path_ / concerned[0]))
        for (const auto& name : names) moves.move(folder_ / name, old.path_ / name);
    for (auto name = names.rbegin(); name != names.rend(); ++name)
        moves.move(path_ / *name, folder_ / *name);
    if (!moves.fault) return;
    if (!moves.takeBack()) old.path_.clear();  // it holds what is nowhere else: it stays
    throw Error("cannot write '" + output_ + "': " + moves.fault.message());
}

std::string PartialFolder::asInPlace(std::string message) const {
    const std::string here = path_.string();
    for (std::size_t at; (at = message.find(here)) != message.npos;)
        message.replace(at, here.size(), folder_.string());
    return message;
}

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
                        "' is not a regular file; remove it");
        }
        if (flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
            close(file_);
            throw Error("'" + output +
                        "' is being written by another program; wait or choose another name");
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

TargetFolder::TargetFolder(const fs::path& path) : path_(path) {
    std::error_code fault;
    if (fs::exists(path, fault) && !fs::is_directory(path, fault))
        throw Error("'" + path.string() + "' exists and is not a folder; choose another name");
    made_ = fs::create_directories(path, fault);
    if (fault) throw Error("cannot create the folder '" + path.string() + "': " + fault.message());
    lock_.emplace(path.string());
}

TargetFolder::~TargetFolder() {
    lock_.reset();
    std::error_code ignored;
    if (made_) fs::remove(path_, ignored);  // only an empty one
}

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
