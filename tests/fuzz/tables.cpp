#include "run/tables.h"
#include "delio/formats/scan_table.h"
#include "delio/run/summary.h"
#include "target.h"

/** The tables and the summary of a run's folder. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace delio;
    fuzz::Input input(data, size);
    const auto kind = input.pick(4);
    const std::string file = fuzz::fileOf(input.rest(), "table");
    return fuzz::mayRefuse([&] {
        if (kind == 0) io::readScanTable(file);
        if (kind == 1) run::readLoopTable(file);
        if (kind == 2) run::readLocalisationTable(file);
        if (kind == 3) run::readSummary(file);
    });
}
