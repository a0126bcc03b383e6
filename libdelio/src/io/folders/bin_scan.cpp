#include "bin_scan.h"

#include <cmath>
#include <cstring>

#include "delio/core/error.h"
#include "file_bytes.h"

namespace delio::io {
namespace {
/** 0: neither. */
std::size_t numbersAPoint(const std::vector<std::uint8_t>& bytes) {
    constexpr std::size_t kKitti = 4, kNuScenes = 5;
    constexpr float kMostRings = 256;
    if (bytes.size() % (kNuScenes * sizeof(float)) == 0) {
        bool rings = true;
        for (std::size_t at = 16; rings && at < bytes.size(); at += 20) {
            float ring = 0;
            std::memcpy(&ring, &bytes[at], sizeof(ring));
            rings = ring >= 0 && ring < kMostRings && ring == std::floor(ring);
        }
        if (rings) return kNuScenes;
    }
    return bytes.size() % (kKitti * sizeof(float)) == 0 ? kKitti : 0;
}
}  // namespace

CloudRecords BinScans::read(const std::filesystem::path& file) {
    CloudRecords records;
    records.bytes = bytesOfFile(file);
    const std::size_t size = records.bytes.size();
    if (size == 0) throw Error("'" + file.string() + "' is empty");
    const std::size_t numbers = numbers_ > 0 ? numbers_ : numbersAPoint(records.bytes);
    if (numbers == 0 || size % (numbers * sizeof(float)) != 0)
        throw Error("'" + file.string() + "' is cut off, or no scan of x y z intensity" +
                    (numbers == 5 ? " ring" : "") + ": its size (" + std::to_string(size) +
                    " bytes) is no multiple of " + (numbers == 5 ? "20" : "16"));
    numbers_ = numbers;
    std::vector<Column> columns{{"x"}, {"y"}, {"z"}, {"intensity"}};
    if (numbers == 5) columns.push_back({"ring"});
    records.layout = layoutOf(columns);
    records.count = size / records.layout.step;
    return records;
}
}  // namespace delio::io
