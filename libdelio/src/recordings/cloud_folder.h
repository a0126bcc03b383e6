#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "files_reader.h"
#include "formats/bin_cloud.h"
#include "formats/point_records.h"
#include "point_table.h"

namespace delio::io {
/** Reads a folder of .pcd, .ply, .bin, .txt or .csv files, one scan each (see ScanTimes). There are
 *  no metadata, so meta() is empty; `stamp_s` is that of the source. */
class CloudFolder : public FilesReader {
 public:
    /** `binLayout`: of .bin files (see BinScans). Throws Error if there are no such files or
     *  several kinds, and as timesOf(). */
    explicit CloudFolder(const std::filesystem::path& folder, const std::string& binLayout = "");

    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override;
    earth::Fixes takeFixes() override;

 protected:
    const std::vector<std::filesystem::path>& files() const override { return files_; }
    Scan read(std::size_t index) override;

 private:
    void lookAtTimes();

    std::vector<std::filesystem::path> files_;
    std::string extension_;
    ScanTimes times_;
    std::shared_ptr<BinScans> bins_;  //!< null: they are of another kind
    std::function<CloudRecords(const std::filesystem::path&)> readRecords_;
    PointTable table_;
    bool pointTimes_ = false;
    std::optional<DriveMeta> meta_;
    std::optional<std::filesystem::path> fixes_;  //!< file with them, until it was read
};
}  // namespace delio::io
