#include "row_files.h"

#include <cerrno>
#include <cstring>

#include "delio/core/error.h"
#include "delio/run/run_folder.h"
#include "scan_row.h"

namespace delio::run {
namespace {
[[noreturn]] void cannotWrite(const std::filesystem::path& path) {
    throw Error("cannot write '" + path.string() + "': " + std::strerror(errno));
}
}  // namespace

void RowFiles::File::write(const std::string& line) {
    if (!file) file.reset(std::fopen(path.c_str(), "wb"));
    if (!file || std::fwrite(line.data(), 1, line.size(), file.get()) != line.size())
        cannotWrite(path);
}

void RowFiles::File::flush() {
    if (file && std::fflush(file.get()) != 0) cannotWrite(path);
}

RowFiles::RowFiles(const std::filesystem::path& folder) {
    scans_.path = folder / RunFolder::kScans;
    trajectory_.path = folder / RunFolder::kOdometry;
    scans_.write("");
    trajectory_.write("");
}

void RowFiles::add(const RunRow& row, const Eigen::Isometry3d& pose) {
    const auto cells = scanRowOf(row);
    if (!hasHeading_) scans_.write(scanTableHeading(cells));
    hasHeading_ = true;
    scans_.write(scanTableLine(cells));
    trajectory_.write(io::kittiRow(pose));
}

void RowFiles::flush() {
    scans_.flush();
    trajectory_.flush();
}
}  // namespace delio::run
