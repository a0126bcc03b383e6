#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "delio/earth/fix.h"
#include "delio/formats/drive_meta.h"
#include "delio/odometry/imu.h"

namespace delio::io {
/** A drive in one of KITTI's two layouts, as it lies on the disk. */
struct KittiDrive {
    DriveMeta meta;                            //!< with the correction that KITTI's sensor needs
    std::vector<std::filesystem::path> scans;  //!< in order of their numbers
    std::vector<double> times_s;               //!< one per scan, since meta.epoch_s
    std::vector<std::string> timeRows;  //!< one per scan, as written in times.txt; may be empty
    std::vector<std::string> poseRows;  //!< one per scan, in the cam0 frame; may be empty
    earth::Fixes fixes;                 //!< one per scan, of OXTS; may be empty
    std::vector<ImuSample> imu;  //!< of OXTS, from 1 s before the first scan to 1 s after the last
    std::string calibText;       //!< of calib.txt; empty without calibration
    std::string posesName;       //!< file name of the poses, even if it does not exist
    std::string calibName;       //!< file of the calibration, likewise
    bool nominalTimes = false;   //!< no stamps: 0.1 s apart is assumed
    std::vector<std::string> warnings;  //!< missing optional parts
};

/** The folder of the drive where `folder` is its velodyne/ (beside calib.txt, times.txt or
 *  poses.txt), velodyne_points/ or velodyne_points/data/; otherwise `folder`. */
std::filesystem::path kittiFolderOf(const std::filesystem::path& folder);

/** Reads everything but the scans of `count` scans from the `start`-th on (0: to the end).
 *  `folder` is a KITTI odometry sequence (velodyne/, and where they are there calib.txt, times.txt,
 *  poses.txt; also dataset/poses/NN.txt as KITTI ships them) or a KITTI raw drive
 *  (velodyne_points/; calibration in the date folder above it; OXTS readings become poses).
 *  Throws Error with one line for anything that cannot be used. */
KittiDrive openKittiDrive(const std::filesystem::path& folder, std::size_t start,
                          std::size_t count);
}  // namespace delio::io
