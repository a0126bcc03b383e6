#include "delio/io/scan_reader.h"

#include <filesystem>

#include "bags/bag_reader.h"
#include "delio/core/error.h"
#include "delio/core/printable.h"
#include "delio/io/rawlog_reader.h"
#include "file_kind.h"
#include "folders/folder_reader.h"
#include "names.h"
#include "packets/pcap_reader.h"
#include "recognised_reader.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
std::unique_ptr<ScanReader> openFolder(const ScanSource& source) {
    if (isKittiFolder(source.path)) return openKittiFolder(source);
    if (fs::exists(fs::path(source.path) / "metadata.yaml")) return openRos2Folder(source);
    return openCloudFolder(source);
}

std::unique_ptr<ScanReader> openFile(const ScanSource& source) {
    switch (kindOf(source.path)) {
        case FileKind::kPcap:
            return openPcap(source);
        case FileKind::kRos1Bag:
            return openRos1Bag(source);
        case FileKind::kRos2Database:
            return openRos2Database(source);
        case FileKind::kMcap:
            return openMcap(source);
        case FileKind::kRawlog:
            break;
    }
    return std::make_unique<RawlogReader>(source.path, source.label, source.imagesFolder);
}
}  // namespace

std::unique_ptr<ScanReader> openScans(const ScanSource& source) {
    if (source.path != "-" && !fs::exists(source.path))
        throw Error("cannot read '" + source.path + "': no such file or folder");
    if (source.path != "-" && !fs::is_directory(source.path) && !fs::is_regular_file(source.path))
        throw Error("'" + source.path +
                    "' is neither a file nor a folder: a pipe is read from standard input, by the "
                    "name -");
    return std::make_unique<RecognisedReader>(fs::is_directory(source.path) ? openFolder(source)
                                                                            : openFile(source));
}

std::unique_ptr<ScanReader> openScans(const std::string& path, const std::string& label,
                                      const std::string& imagesFolder) {
    return openScans({path, label, imagesFolder, ""});
}

std::string nameOfDrive(const std::string& path) {
    if (path == "-") return "stdin";
    const fs::path whole = fs::absolute(fs::path(path) / "").lexically_normal().parent_path();
    const std::string name =
        printable(fs::is_directory(whole) ? whole.filename().string() : whole.stem().string());
    if (!isFileName(name))
        throw Error("a drive cannot be called '" + name + "', as '" + path +
                    "' is: rename the recording");
    return name;
}
}  // namespace delio::io
