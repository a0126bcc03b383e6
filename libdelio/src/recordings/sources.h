#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "delio/recordings/scan_reader.h"
#include "packet_source.h"

namespace delio::io {
enum class FileKind { kRawlog, kPcap, kRos1Bag, kRos2Database, kMcap, kOsf };

/** Format of a file by its first bytes; "-": standard input, from which nothing is consumed.
 *  Unrecognised files are treated as rawlogs, which have no magic number. Throws Error if the file
 *  cannot be read, is a single cloud, or has a known but unsupported format. */
FileKind kindOf(const std::string& path);

/** Read the messages with scans of one topic. Throw as openScans(). */
std::unique_ptr<ScanReader> openRos1Bag(const ScanSource& source);
/** A .db3 file. */
std::unique_ptr<ScanReader> openRos2Database(const ScanSource& source);
std::unique_ptr<ScanReader> openMcap(const ScanSource& source);
/** A folder with metadata.yaml and the .db3 or .mcap files that it names. */
std::unique_ptr<ScanReader> openRos2Folder(const ScanSource& source);

/** Topics with scans of a bag, by name; none where `path` is no bag or cannot be read. */
std::vector<std::string> scanTopicsOf(const std::string& path);

/** Reads a pcap or pcapng of a Velodyne, Hesai, RoboSense or Ouster (whose .json lies beside it, or
 *  is `sensorFile`). Path "-": standard input. Throws as openScans(). */
std::unique_ptr<ScanReader> openPcap(const ScanSource& source);

/** Ouster's own format: the turns of one of its sensors, whose label is its serial number. Throws
 * as openScans(). */
std::unique_ptr<ScanReader> openOsf(const ScanSource& source);

/** Reads packets of any source. */
std::unique_ptr<ScanReader> openPackets(const ScanSource& source,
                                        std::shared_ptr<PacketSource> packets);

/** Listens at `source.path`, "udp://...". Throws as openScans(). */
std::unique_ptr<ScanReader> openLive(const ScanSource& source);

/** True for a KITTI odometry sequence (velodyne/) or raw drive (velodyne_points/data/). */
bool isKittiFolder(const std::filesystem::path& folder);
/** The scans of a KITTI folder in place: the same, to the bit, as by way of kitti2rawlog. */
std::unique_ptr<ScanReader> openKittiFolder(const ScanSource& source);
/** A folder of .pcd, .ply, .bin, .txt or .csv files, a scan each, in the natural order of their
 *  names. Throws as openScans(). */
std::unique_ptr<ScanReader> openCloudFolder(const ScanSource& source);
}  // namespace delio::io
