#include "files_reader.h"

namespace delio::io {
std::optional<Scan> FilesReader::next() {
    if (count_ >= files().size()) return {};
    const std::size_t index = count_;
    count_ = files().size();  // should it fail
    Scan scan = read(index);
    scan.index = index;
    count_ = index + 1;
    return scan;
}

bool FilesReader::skip() {
    if (count_ >= files().size()) return false;
    ++count_;
    return true;
}

std::optional<double> FilesReader::fraction() const {
    return static_cast<double>(count_) / static_cast<double>(files().size());
}
}  // namespace delio::io
