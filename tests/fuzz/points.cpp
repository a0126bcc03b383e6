#include "delio/map/cloud_files.h"
#include "target.h"

/** Maps of points: .ply, .pcd and .las. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    const auto kind = input.pick(3);
    return fuzz::mayRefuse([&] {
        if (kind == 2) map::loadLas(fuzz::fileOf(input.rest(), "map.las"));
        if (kind == 1) map::loadPcd(fuzz::fileOf(input.rest(), "map.pcd"));
        if (kind == 0) map::loadPly(fuzz::fileOf(input.rest(), "map.ply"));
    });
}
