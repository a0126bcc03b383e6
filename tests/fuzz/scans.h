#pragma once
#include "delio/recordings/scan_reader.h"
#include "recordings/sources.h"
#include "target.h"

namespace delio::fuzz {
/** Reads a recording as delio-slam does. */
inline int readScans(const io::ScanSource& source) {
    return mayRefuse([&] {
        const auto reader = io::openScans(source);
        reader->calibration();
        reader->truth();
        while (reader->next()) reader->fraction();
        reader->takeImu();
        io::describe(reader->recording());
    });
}

/** The same of a file of one kind: what is not taken for it is another target's. */
inline int readScans(const io::ScanSource& source, io::FileKind kind) {
    bool is = false;
    mayRefuse([&] { is = io::kindOf(source.path) == kind; });
    return is ? readScans(source) : 0;
}
}  // namespace delio::fuzz
