#include "delio/io/scan_reader.h"

#include "delio/io/rawlog_reader.h"

namespace delio::io {
std::unique_ptr<ScanReader> openScans(const ScanSource& source) {
    return std::make_unique<RawlogReader>(source.path, source.label, source.imagesFolder);
}

std::unique_ptr<ScanReader> openScans(const std::string& path, const std::string& label,
                                      const std::string& imagesFolder) {
    return openScans({path, label, imagesFolder, ""});
}
}  // namespace delio::io
