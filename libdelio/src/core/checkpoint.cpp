#include "checkpoint.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <istream>
#include <ostream>

namespace delio::checkpoint {
namespace {
constexpr std::array<char, 8> kMagic = {'D', 'e', 'L', 'i', 'O', 's', 't', 'a'};
/** Of all serialize() together: one more with every change of what they keep. */
constexpr std::uint32_t kFormat = 4;

/** Begins every part. Without gaps, for it is written as it lies in memory. */
struct Header {
    std::array<char, 8> magic = kMagic;
    std::uint32_t format = kFormat;
    std::uint32_t name = 0, options = 0, bytes = 0;  //!< checksums
    std::uint64_t size = 0;                          //!< of the bytes
};
static_assert(sizeof(Header) == 32);

std::uint32_t checksumOf(const std::string& text) {
    return static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}

[[noreturn]] void refuse(const Label& label, const std::string& why) {
    throw Error("the stored state of the drive " + why + " (in its part '" + label.name +
                "'): begin the drive again");
}
}  // namespace

std::string textOf(const std::vector<const StageOptions*>& stages) {
    std::ostringstream text;
    for (const auto* stage : stages) stage->write(text, "");
    return text.str();
}

void writePart(std::ostream& out, const Label& label, const std::string& bytes) {
    Header header;
    header.name = checksumOf(label.name);
    header.options = checksumOf(label.options);
    header.bytes = checksumOf(bytes);
    header.size = bytes.size();
    out.write(reinterpret_cast<const char*>(&header), sizeof(header));
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out)
        throw Error("the state of the drive cannot be written (its part '" + label.name +
                    "'): is the disk full?");
}

std::string readPart(std::istream& in, const Label& label) {
    Header header;
    if (!in.read(reinterpret_cast<char*>(&header), sizeof(header))) refuse(label, "is cut off");
    if (header.magic != kMagic) refuse(label, "is damaged, or is none");
    if (header.format != kFormat) refuse(label, "is of another version of DeLiO");
    if (header.name != checksumOf(label.name)) refuse(label, "has other parts");
    if (header.options != checksumOf(label.options)) refuse(label, "was made with other options");
    // A size that is damaged asks for no more memory than there are bytes.
    constexpr std::uint64_t kAtOnce = 1U << 24U;
    std::string bytes;
    while (bytes.size() < header.size) {
        const std::size_t before = bytes.size(),
                          more = std::min<std::uint64_t>(kAtOnce, header.size - before);
        bytes.resize(before + more);
        if (!in.read(&bytes[before], static_cast<std::streamsize>(more)))
            refuse(label, "is cut off");
    }
    if (header.bytes != checksumOf(bytes)) refuse(label, "is damaged");
    return bytes;
}

void misfit(const Label& label) { refuse(label, "does not fit"); }
}  // namespace delio::checkpoint
