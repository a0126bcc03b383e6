#include "scans.h"

/** A rawlog with all in it. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio::fuzz;
    return readScans({fileOf(Input(data, size).rest(), "d.rawlog"), "", "", ""},
                     delio::io::FileKind::kRawlog);
}
