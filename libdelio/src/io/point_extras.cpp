#include "point_extras.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "side_file.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
template <typename Value>
void readValues(const std::string& file, std::size_t count, std::vector<Value>& values) {
    if (!isFileThere(file)) return;
    const auto bytes = fs::file_size(file);
    if (bytes != count * sizeof(Value))
        throw Error("'" + file + "' has " + std::to_string(bytes) + " bytes, but its scan has " +
                    std::to_string(count) + " points of " + std::to_string(sizeof(Value)) +
                    " bytes each");
    values.resize(count);
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(bytes));
    if (!in) throw Error("cannot read '" + file + "'");
}
}  // namespace

void readPointExtras(const std::string& stem, Scan& scan) {
    const std::size_t count = scan.points->size();
    readValues(stem + ".ring", count, scan.rings);
    readValues(stem + ".time", count, scan.times_s);
    constexpr float kLongest_s = 1;  // no LiDAR turns slower than so
    for (const float time_s : scan.times_s)
        if (std::abs(time_s) > kLongest_s)
            throw Error("'" + stem + ".time' has a time of " + digitsOf(time_s) +
                        " s from its scan's stamp");
}
}  // namespace delio::io
