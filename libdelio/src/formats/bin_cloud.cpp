#include "bin_cloud.h"

#include <algorithm>
#include <string_view>

#include "delio/core/error.h"
#include "files/input_file.h"

namespace delio::io {
namespace {
[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& why) {
    throw Error("'" + file.string() + "' " + why);
}

/** Where the points seem to have another size than those of all layouts. */
void refuseOtherSize(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
    for (const std::size_t step : {12U, 20U, 24U, 28U, 32U, 36U, 48U})
        if (beginWithFloats(bytes, step))
            refuse(file, "looks like points of " + std::to_string(step) +
                             " bytes each, of no known layout; choose one with --sensor-label (" +
                             binLayoutNames() + "), or write the scans as .pcd files");
}

const BinLayout& layoutOf(const std::filesystem::path& file,
                          const std::vector<std::uint8_t>& bytes) {
    const auto found = binLayoutsOf(bytes);
    if (found.size() == 1) return *found.front();
    if (found.empty()) {
        refuseOtherSize(file, bytes);
        return binLayoutNamed("kitti");
    }
    std::string names;
    for (const BinLayout* layout : found)
        names += (names.empty() ? "" : " and ") + std::string(layout->name);
    refuse(file, "fits the layouts " + names + "; choose one with --sensor-label LAYOUT");
}

/** Rows of a cloud that was written row by row: times begin again with each. 1: it was not. */
std::size_t rowsOf(const CloudRecords& records, std::size_t timeAt) {
    std::uint32_t before = 0, time = 0;
    std::size_t rows = 1;
    for (std::size_t i = 0; i < records.count; ++i, before = time) {
        std::copy_n(&records.bytes[i * records.layout.step + timeAt], sizeof(time),
                    reinterpret_cast<std::uint8_t*>(&time));
        if (time < before) ++rows;
    }
    return records.count % rows == 0 ? rows : 1;
}
}  // namespace

void refuseOtherLayout(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
    for (const BinLayout* layout : binLayoutsOf(bytes))
        if (layout->step() != 16)
            refuse(file, "has points of " + std::to_string(layout->step()) +
                             " bytes each (layout " + layout->name +
                             "), and KITTI's have 16; give the folder of the .bin files itself");
    if (!beginWithFloats(bytes, 16)) refuseOtherSize(file, bytes);
}

BinScans::BinScans(const std::string& layout)
    : layout_(layout.empty() ? nullptr : &binLayoutNamed(layout)) {}

CloudRecords BinScans::read(const std::filesystem::path& file) {
    auto bytes = bytesOfFile(file);
    if (bytes.empty()) refuse(file, "is empty");
    const BinLayout& layout = layout_ ? *layout_ : layoutOf(file, bytes);
    if (bytes.size() % layout.step() != 0)
        refuse(file, "is cut off, or not a scan of the layout " + std::string(layout.name) +
                         ": its size (" + std::to_string(bytes.size()) +
                         " bytes) is not a multiple of " + std::to_string(layout.step()));
    layout_ = &layout;
    const std::string_view name = layout.name;
    if (name == "nclt") return recordsOfNclt(bytes);
    if (name == "mulran") return recordsOfMulran(bytes);
    CloudRecords records;
    records.layout = io::layoutOf(layout.columns);
    records.count = bytes.size() / layout.step();
    records.bytes = std::move(bytes);
    if (name == "pohang") records.rows = rowsOf(records, 16);
    return records;
}
}  // namespace delio::io
