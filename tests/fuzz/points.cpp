#include "delio/map/pcd.h"
#include "delio/map/ply.h"
#include "target.h"

/** Maps of points: .ply and .pcd. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    const bool pcd = input.pick(2) == 1;
    return fuzz::mayRefuse([&] {
        if (pcd)
            map::loadPcd(fuzz::fileOf(input.rest(), "map.pcd"));
        else
            map::loadPly(fuzz::fileOf(input.rest(), "map.ply"));
    });
}
