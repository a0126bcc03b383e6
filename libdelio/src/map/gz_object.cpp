#include "gz_object.h"

#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/serialization/CArchive.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "../io/gz_output.h"
#include "delio/error.h"
#include "delio/io/output_file.h"

namespace delio::map {
namespace {
/** A gzip file ends with the length of what it unpacks to (modulo 2^32). MRPT's stream does not
 *  look at it, so a file that is cut off within its last bytes would pass. */
bool endsWithLength(const std::string& path, std::uint64_t length) {
    std::ifstream in(path, std::ios::binary);
    std::array<char, 2> magic{};
    in.read(magic.data(), 2);
    if (magic != std::array<char, 2>{'\x1f', '\x8b'}) return true;  // not compressed
    in.seekg(-4, std::ios::end);
    std::array<unsigned char, 4> tail{};
    in.read(reinterpret_cast<char*>(tail.data()), 4);
    std::uint32_t stored = 0;
    for (unsigned i = 0; i < 4; ++i) stored |= std::uint32_t{tail[i]} << (8 * i);
    return in && stored == static_cast<std::uint32_t>(length);
}
}  // namespace

void loadWhole(const std::string& path, const std::string& what,
               mrpt::serialization::CSerializable& object) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        throw Error("cannot read '" + path + "': there is no such file");
    bool whole = false;
    try {
        mrpt::io::CFileGZInputStream in(path);
        mrpt::serialization::archiveFrom(in).ReadObject(&object);
        whole = endsWithLength(path, in.getPosition());
    } catch (const std::exception&) {
        // MRPT's message is a stack of nested exceptions; what matters is said below.
    }
    if (!whole) throw Error("'" + path + "' is not " + what + ", or it is cut off; write it again");
}

void saveWhole(const mrpt::serialization::CSerializable& object, const std::string& path) {
    io::replaceFile(path, [&](const std::string& temporary) {
        io::GzOutput out(temporary);
        mrpt::serialization::archiveFrom(out) << object;
        return out.close();
    });
}
}  // namespace delio::map
