#pragma once
#include "delio/io/scan_reader.h"
#include "target.h"

namespace delio::fuzz {
/** Reads a recording as delio-slam does. */
inline int readScans(const io::ScanSource& source) {
    return mayRefuse([&] {
        const auto reader = io::openScans(source);
        reader->calibration();
        reader->truth();
        while (reader->next()) reader->fraction();
        io::describe(reader->recording());
    });
}
}  // namespace delio::fuzz
