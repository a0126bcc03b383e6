#include "row_files.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "delio/core/error.h"
#include "delio/run/run_folder.h"
#include "scan_row.h"

namespace delio::run {
namespace fs = std::filesystem;

void RowFiles::File::flush() {
    if (!file) file.reset(std::fopen(path.c_str(), "wb"));
    const bool written =
        file && std::fwrite(pending.data(), 1, pending.size(), file.get()) == pending.size() &&
        std::fflush(file.get()) == 0;
    if (!written) throw Error("cannot write '" + path.string() + "': " + std::strerror(errno));
    pending.clear();
}

RowFiles::RowFiles(fs::path folder) : folder_(std::move(folder)) {
    std::error_code fault;
    fs::remove_all(folder_, fault);
    if (!fault) fs::create_directories(folder_, fault);
    if (fault) throw Error("cannot make the folder '" + folder_.string() + "': " + fault.message());
    scans_.path = folder_ / RunFolder::kScans;
    trajectory_.path = folder_ / RunFolder::kOdometry;
}

RowFiles::~RowFiles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void RowFiles::addTo(const RunRow& row, const Eigen::Isometry3d& pose) {
    const auto cells = scanRowOf(row);
    if (!hasHeading_) scans_.pending = scanTableHeading(cells);
    hasHeading_ = true;
    scans_.pending += scanTableLine(cells);
    trajectory_.pending += io::kittiRow(pose);
    const auto now = Clock::now();
    if (now < flushAt_) return;
    scans_.flush();
    trajectory_.flush();
    flushAt_ = now + std::chrono::seconds(1);
}

void RowFiles::add(const RunRow& row, const Eigen::Isometry3d& pose) {
    if (givenUp_) return;
    try {
        addTo(row, pose);
    } catch (...) {
        givenUp_ = true;
        for (File* file : {&scans_, &trajectory_}) {
            file->file.reset();
            std::error_code ignored;
            fs::remove(file->path, ignored);
        }
        throw;
    }
}
}  // namespace delio::run
