#include "delio/formats/g2o.h"
#include "target.h"

/** A pose graph. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    return fuzz::mayRefuse(
        [&] { io::loadG2o(fuzz::fileOf(fuzz::Input(data, size).rest(), "posegraph.g2o")); });
}
