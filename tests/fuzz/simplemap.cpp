#include "delio/map/simplemap.h"
#include "target.h"

/** A .simplemap. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    return fuzz::mayRefuse([&] {
        const auto map =
            map::loadSimplemap(fuzz::fileOf(fuzz::Input(data, size).rest(), "map.simplemap"));
        map::pointsOf(map);
        map::posesOf(map);
    });
}
