#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "point_records.h"

namespace delio::io {
/** Throws Error where the bytes of a .bin file are not points of four floats, but look like points
 * of another size. */
void refuseOtherLayout(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes);

/** Reads .bin files of floats: x y z intensity (KITTI) or x y z intensity ring (nuScenes). The
 *  first file decides for the whole drive. */
class BinScans {
 public:
    /** Throws Error, which names the file, for one that is missing, empty, cut off or of
     *  another layout. */
    CloudRecords read(const std::filesystem::path& file);

 private:
    std::size_t numbers_ = 0;  // a point; 0: not known yet
};
}  // namespace delio::io
