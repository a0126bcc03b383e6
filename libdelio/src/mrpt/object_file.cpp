#include "object_file.h"

#include <mrpt/serialization/CArchive.h>

#include <filesystem>

#include "delio/core/error.h"
#include "delio/files/output.h"
#include "files/gz.h"
#include "object_archive.h"

namespace delio::io {
void loadWhole(const std::string& path, const std::string& what, FileOf file,
               mrpt::serialization::CSerializable& object) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error("cannot read '" + path + "': there is no such file");
    GzInput in(path);
    ObjectArchive archive(in, file);
    bool whole = false;
    try {
        archive.nextInto(object);
        char left = 0;
        whole = in.Read(&left, 1) == 0;  // here a checksum that is wrong or missing shows
    } catch (const std::exception&) {
        // MRPT's message is a stack of nested exceptions; what matters is said below.
    }
    if (!archive.refused().empty())
        throw Error("'" + path + "' holds '" + archive.refused() + "', which is not read from " +
                    what);
    if (!whole) throw Error("'" + path + "' is not " + what + ", or it is cut off; write it again");
}

void saveWhole(const mrpt::serialization::CSerializable& object, const std::string& path) {
    replaceFile(path, [&](const std::string& temporary) {
        GzOutput out(temporary);
        mrpt::serialization::archiveFrom(out) << object;
        return out.close();
    });
}
}  // namespace delio::io
