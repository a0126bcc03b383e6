#include "scans.h"

/** A ROS 2 bag of sqlite3. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    return readScans({fileOf(Input(data, size).rest(), "d.db3"), "", "", ""},
                     delio::io::FileKind::kRos2Database);
}
