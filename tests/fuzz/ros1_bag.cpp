#include "scans.h"

/** A ROS 1 bag. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    return readScans({fileOf(Input(data, size).rest(), "d.bag"), "", "", ""},
                     delio::io::FileKind::kRos1Bag);
}
