#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "delio/map/map_builder.h"
#include "stored_scan.h"

namespace delio::map {
/** Input of a map. */
struct MapParts {
    const std::vector<StoredScan>& scans;
    std::shared_ptr<const io::Spool> spool;  //!< null: there are no scans
    const MapOptions& options;
    const std::string& sensorLabel;
};

/** Throws Error if a scan's poseIndex is outside `poses`, or if the disk fails. */
BuiltMap buildMap(const MapParts& parts, const std::vector<Eigen::Isometry3d>& poses);

/** See MapBuilder::seenThrough(). */
std::vector<std::uint8_t> seenThrough(const MapParts& parts,
                                      const std::vector<Eigen::Isometry3d>& poses,
                                      const std::vector<bool>& usable,
                                      const Eigen::Matrix3Xf& points);
}  // namespace delio::map
