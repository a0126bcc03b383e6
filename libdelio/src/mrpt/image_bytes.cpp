#include "object_archive.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace delio::io {
namespace {
template <typename Value>
Value readAs(GzInput& in) {
    Value value{};
    if (in.Read(&value, sizeof(value)) != sizeof(value))
        throw std::runtime_error("the file ends early");
    return value;
}

void skip(GzInput& in, std::uint64_t bytes) {
    std::array<char, 1U << 14> unused{};
    while (bytes > 0) {
        const auto some = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, unused.size()));
        if (in.Read(unused.data(), some) != some) throw std::runtime_error("the file ends early");
        bytes -= some;
    }
}

void skipCounted(GzInput& in) { skip(in, readAs<std::uint32_t>(in)); }

void skipGrey(GzInput& in, std::uint8_t version) {
    skip(in, 3 * sizeof(std::int32_t));  // width, height, origin
    const auto size = readAs<std::uint32_t>(in);
    if (version >= 9) skip(in, sizeof(std::int32_t));  // depth
    constexpr std::uint32_t kSmall = 16 * 1024;        // these version 4 does not compress
    bool isZip = version == 3 || (version == 4 && size > kSmall);
    if (version >= 5) isZip = readAs<std::uint8_t>(in) != 0;
    if (isZip)
        skipCounted(in);
    else
        skip(in, size);
}

void skipColour(GzInput& in, std::uint8_t version) {
    if (version < 7) return skipCounted(in);
    const std::int64_t width = readAs<std::int32_t>(in), height = readAs<std::int32_t>(in);
    if (width >= 1 && height >= 1) return skipCounted(in);  // JPEG
    // Not compressed: the sizes are negative. Width or height of 0: nothing follows.
    if (width < 0 && height < 0) skip(in, static_cast<std::uint64_t>(width * height) * 3);
}
}  // namespace

void skipImage(GzInput& in, std::uint8_t version) {
    constexpr std::uint8_t kOnlyWhere = 100;
    if (version == 0) {
        skip(in, 3 * sizeof(std::uint32_t) + 1);  // width, height, channels, origin
        return skipCounted(in);
    }
    if (version == 1) return skipCounted(in);
    if (version > 9 && version != kOnlyWhere) throw std::runtime_error("an image of no known kind");
    if (version >= 6 && readAs<std::uint8_t>(in) != 0) return skipCounted(in);  // a file's name
    if (version == kOnlyWhere) return;
    if (readAs<std::uint8_t>(in) == 0)
        skipGrey(in, version);
    else
        skipColour(in, version);
}
}  // namespace delio::io
