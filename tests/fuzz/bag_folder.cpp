#include "scans.h"

/** metadata.yaml of a ROS 2 bag, beside a file that it may name. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    fileOf(Input(data, size).rest(), "bag/metadata.yaml");
    fileOf("\x89MCAP0\r\n", "bag/bag_0.mcap");
    return readScans({(folder() / "bag").string(), "", "", ""});
}
