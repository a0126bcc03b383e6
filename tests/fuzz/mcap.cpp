#include "scans.h"

/** An MCAP file. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    return readScans({fileOf(Input(data, size).rest(), "d.mcap"), "", "", ""},
                     delio::io::FileKind::kMcap);
}
