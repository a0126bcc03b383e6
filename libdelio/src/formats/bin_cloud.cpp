#include "bin_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "delio/core/error.h"
#include "files/input_file.h"

namespace delio::io {
namespace {
/** True where points of that many bytes begin with x, y and z as floats: neither huge nor so small
 *  that a whole number was taken for a float. */
bool areFloats(const std::vector<std::uint8_t>& bytes, std::size_t step) {
    constexpr float kLeast = 1e-9F, kMost = 1e7F;
    constexpr std::size_t kSample = 500;
    const std::size_t count = bytes.size() / step;
    if (count == 0 || bytes.size() % step != 0) return false;
    std::size_t points = 0, good = 0;
    for (std::size_t i = 0; i < count; i += 1 + count / kSample, ++points) {
        float xyz[3];
        std::memcpy(xyz, &bytes[i * step], sizeof(xyz));
        good += std::all_of(xyz, xyz + 3, [](float value) {
            const float size = std::abs(value);
            return value == 0 || std::isnan(value) || (size > kLeast && size < kMost);
        });
    }
    return static_cast<double>(good) >= 0.98 * static_cast<double>(points);
}

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

void refuseOtherLayout(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
    if (areFloats(bytes, 16)) return;
    for (const std::size_t step : {12U, 20U, 24U, 28U, 32U, 36U, 48U})
        if (areFloats(bytes, step))
            throw Error("'" + file.string() + "' looks like points of " + std::to_string(step) +
                        " bytes each, not 16 (x y z intensity) or 20 (x y z intensity ring); write "
                        "the scans as .pcd files");
}

CloudRecords BinScans::read(const std::filesystem::path& file) {
    CloudRecords records;
    records.bytes = bytesOfFile(file);
    const std::size_t size = records.bytes.size();
    if (size == 0) throw Error("'" + file.string() + "' is empty");
    const std::size_t numbers = numbers_ > 0 ? numbers_ : numbersAPoint(records.bytes);
    if (numbers_ == 0 && numbers != 5) refuseOtherLayout(file, records.bytes);
    if (numbers == 0 || size % (numbers * sizeof(float)) != 0)
        throw Error("'" + file.string() + "' is cut off, or not a scan of x y z intensity" +
                    (numbers == 5 ? " ring" : "") + ": its size (" + std::to_string(size) +
                    " bytes) is not a multiple of " + (numbers == 5 ? "20" : "16"));
    numbers_ = numbers;
    std::vector<Column> columns{{"x"}, {"y"}, {"z"}, {"intensity"}};
    if (numbers == 5) columns.push_back({"ring"});
    records.layout = layoutOf(columns);
    records.count = size / records.layout.step;
    return records;
}
}  // namespace delio::io
