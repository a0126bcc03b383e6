#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bin_layouts.h"
#include "point_records.h"

namespace delio::io {
/** Throws Error where the bytes of a .bin file are not points of four floats, but look like points
 * of another layout. */
void refuseOtherLayout(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes);

/** Reads .bin files of records without a header (see binLayouts()). The first file decides for the
 *  whole drive. */
class BinScans {
 public:
    /** `layout`: its name; empty: the one that the first file fits. Throws Error for an unknown
     *  one. */
    explicit BinScans(const std::string& layout = "");

    /** Throws Error, which names the file, for one that is missing, empty, cut off or of
     *  another layout. */
    CloudRecords read(const std::filesystem::path& file);

    /** Null before the first file. */
    const BinLayout* layout() const { return layout_; }

 private:
    const BinLayout* layout_ = nullptr;
};
}  // namespace delio::io
