#pragma once
#include <memory>
#include <string>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** Reads a pcap or pcapng of a Velodyne or an Ouster (whose .json lies beside it, or is
 *  `sensorFile`). Path "-": standard input. Throws as openScans(). */
std::unique_ptr<ScanReader> openPcap(const ScanSource& source);
}  // namespace delio::io
