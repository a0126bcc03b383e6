#include "delio/picture/scene.h"
#include "picture/view.h"
#include "target.h"

/** A .3Dscene, and what delio-snapshot looks for in it. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    return fuzz::mayRefuse([&] {
        const auto scene =
            picture::loadScene(fuzz::fileOf(fuzz::Input(data, size).rest(), "map.3Dscene"));
        picture::contentOf(*scene);
    });
}
