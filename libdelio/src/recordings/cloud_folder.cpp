#include "cloud_folder.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include "delio/core/error.h"
#include "delio/formats/georeference.h"
#include "files/names.h"
#include "formats/bin_cloud.h"
#include "formats/las.h"
#include "formats/pcd.h"
#include "formats/ply.h"
#include "formats/text_cloud.h"
#include "mrpt/clock.h"
#include "sources.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
using ReadRecords = std::function<CloudRecords(const fs::path&)>;

/** Nothing where files of that extension are no scans. `bins` reads .bin files. */
ReadRecords recordsReader(const std::string& extension,
                          const std::shared_ptr<BinScans>& bins = nullptr) {
    if (extension == ".pcd") return [](const fs::path& file) { return readPcdScan(file.string()); };
    if (extension == ".ply") return [](const fs::path& file) { return readPlyScan(file.string()); };
    if (extension == ".las") return [](const fs::path& file) { return readLasScan(file.string()); };
    if (extension == ".bin") return [bins](const fs::path& file) { return bins->read(file); };
    if (extension == ".txt" || extension == ".csv") return readTextScan;
    return {};
}

std::string lowerCase(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/** Texts that often lie beside scans. */
bool isSideText(const fs::path& file) {
    if (isTimesFile(file) || isFixesFile(file)) return true;
    const std::string stem = lowerCase(file.stem().string());
    const std::string extension = lowerCase(file.extension().string());
    if (extension != ".txt" && extension != ".csv") return false;
    for (const char* name : {"calib", "imu", "license", "poses", "readme"})
        if (stem == name) return true;
    return false;
}

using FilesByExtension = std::map<std::string, std::vector<fs::path>>;

FilesByExtension scansIn(const fs::path& folder) {
    if (!fs::is_directory(folder)) throw Error("'" + folder.string() + "' is not a folder");
    FilesByExtension files;
    std::error_code fault;
    for (const auto& entry : fs::directory_iterator(folder, fault)) {
        const std::string extension = lowerCase(entry.path().extension().string());
        const bool hidden = entry.path().filename().string()[0] == '.';
        if (!hidden && entry.is_regular_file(fault) && recordsReader(extension) &&
            !isSideText(entry.path()))
            files[extension].push_back(entry.path());
    }
    if (files.empty() && fault)
        throw Error("cannot read the folder '" + folder.string() + "': " + fault.message());
    return files;
}

/** The first KITTI folder by name, up to two levels below this one; empty if there is no such
 * folder.
 */
fs::path kittiFolderIn(const fs::path& folder, int levels = 2) {
    std::vector<fs::path> inner;
    std::error_code fault;
    for (const auto& entry : fs::directory_iterator(folder, fault))
        if (entry.is_directory(fault)) inner.push_back(entry.path());
    std::sort(inner.begin(), inner.end());
    for (const auto& one : inner)
        if (isKittiFolder(one)) return one;
    for (const auto& one : inner) {
        if (levels == 1) break;
        if (const auto found = kittiFolderIn(one, levels - 1); !found.empty()) return found;
    }
    return {};
}

/** The one kind there is. */
FilesByExtension::value_type onlyKindOf(const FilesByExtension& files, const fs::path& folder) {
    if (files.empty()) {
        const fs::path drive = kittiFolderIn(folder);
        throw Error("'" + folder.string() +
                    "' contains no .pcd, .ply, .las, .bin, .txt or .csv: no scans" +
                    (drive.empty() ? ""
                                   : ", only folders of KITTI drives; give one of them, such as '" +
                                         drive.string() + "'"));
    }
    if (files.size() == 1) return *files.begin();
    std::string kinds;
    for (const auto& [extension, ofKind] : files)
        kinds += (kinds.empty() ? "" : ", ") + std::to_string(ofKind.size()) + " " + extension;
    throw Error("'" + folder.string() + "' contains several kinds of files (" + kinds +
                "); keep only one kind");
}
}  // namespace

CloudFolder::CloudFolder(const fs::path& folder, const std::string& binLayout)
    : FilesReader("lidar") {
    auto [extension, files] = onlyKindOf(scansIn(folder), folder);
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
        return naturallyBefore(a.filename().string(), b.filename().string());
    });
    times_ = timesOf(folder, files);
    setImu(imuBeside(folder));
    fixes_ = fixesBeside(folder);
    files_ = std::move(files);
    if (extension == ".bin") bins_ = std::make_shared<BinScans>(binLayout);
    readRecords_ = recordsReader(extension, bins_);
    extension_ = extension;
    lookAtTimes();
}

/** The meaning of point times is inferred from several scans. A fault is reported when its scan is
 *  read. */
void CloudFolder::lookAtTimes() {
    constexpr std::size_t kScans = 8;  // some may be empty
    try {
        for (std::size_t i = 0; i < std::min(kScans, files_.size()); ++i) {
            const auto records = readRecords_(files_[i]);
            if (bins_ && !hasTimes(records.layout)) return;  // no file will have any
            if (!table_.look(records.layout, records.bytes.data(), records.bytes.size(),
                             records.count, times_.stamps_s[i]))
                return;
        }
    } catch (const Error&) {
    }
}

Recording CloudFolder::recording() const {
    const std::string layout = bins_ && bins_->layout() ? bins_->layout()->name : "";
    Recording recording;
    recording.kind = "folder of " + extension_ + " files" +
                     (layout.empty() || layout == "kitti" ? "" : ", layout " + layout) +
                     (times_.nominal ? ", nominal times" : "");
    recording.pointTimes = pointTimes_;
    if (hasImu()) recording.imu = "imu.csv";
    recording.scans = files_.size();
    recording.findings = table_.findings();
    return recording;
}

Scan CloudFolder::read(std::size_t index) {
    const auto records = readRecords_(files_[index]);
    const double stamp_s = times_.stamps_s[index];
    Scan scan;
    try {
        scan = table_.scan(records.layout, records.bytes.data(), records.bytes.size(),
                           records.count, records.rows, {stamp_s, index});
    } catch (const Error& e) {
        throw Error("'" + files_[index].string() + "': " + e.what());
    }
    pointTimes_ = pointTimes_ || !scan.times_s.empty();
    scan.stamp_s = stamp_s;
    scan.time = timeOf(stamp_s, times_.epoch_s);
    return scan;
}

earth::Fixes CloudFolder::takeFixes() {
    const auto file = std::exchange(fixes_, {});
    return file ? readFixes(*file) : earth::Fixes{};
}

std::unique_ptr<ScanReader> openCloudFolder(const ScanSource& source) {
    return std::make_unique<CloudFolder>(source.path, source.label);
}
}  // namespace delio::io
