#pragma once
#include <filesystem>
#include <memory>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** True for a KITTI odometry sequence (velodyne/) or raw drive (velodyne_points/data/). */
bool isKittiFolder(const std::filesystem::path& folder);
/** The scans of a KITTI folder in place: the same, to the bit, as by way of kitti2rawlog. */
std::unique_ptr<ScanReader> openKittiFolder(const ScanSource& source);
/** A folder of .pcd, .ply, .bin, .txt or .csv files, a scan each, in the natural order of their
 *  names. Throws as openScans(). */
std::unique_ptr<ScanReader> openCloudFolder(const ScanSource& source);
}  // namespace delio::io
