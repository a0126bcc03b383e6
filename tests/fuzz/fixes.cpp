#include "delio/formats/georeference.h"
#include "target.h"

/** GNSS fixes as csv and NMEA, and a georeference. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    const auto kind = input.pick(3);
    const std::string file = fuzz::fileOf(input.rest(), kind == 0   ? "gnss.csv"
                                                        : kind == 1 ? "gnss.nmea"
                                                                    : "georeference.yaml");
    return fuzz::mayRefuse([&] {
        if (kind < 2)
            io::readFixes(file);
        else
            io::readGeoreference(file);
    });
}
