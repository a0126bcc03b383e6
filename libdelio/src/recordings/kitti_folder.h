#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "delio/recordings/kitti_drive.h"
#include "files_reader.h"

namespace delio::io {
/** Reads the scans of a KITTI odometry sequence or raw drive where they lie: the same, to the bit,
 *  as those that RawlogReader gives of what kitti2rawlog makes of it. */
class KittiReader : public FilesReader {
 public:
    /** `folder`: of the sequence or drive, or that of its scans. Throws Error as
     *  openKittiDrive(). */
    explicit KittiReader(const std::filesystem::path& folder);

    /** Missing optional parts, one line each. */
    const std::vector<std::string>& warnings() const { return drive_.warnings; }

    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override;
    SideFile calibration() const override { return {drive_.calibName, drive_.calibText}; }
    SideFile truth() const override;
    earth::Fixes takeFixes() override;

 protected:
    const std::vector<std::filesystem::path>& files() const override { return drive_.scans; }
    /** Throws Error where the size of the file is no multiple of 16 bytes. */
    Scan read(std::size_t index) override;

 private:
    KittiDrive drive_;
    std::optional<DriveMeta> meta_;
    std::optional<std::filesystem::path> fixesFile_;  //!< instead of OXTS, until it was read
};
}  // namespace delio::io
