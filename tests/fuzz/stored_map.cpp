#include <zlib.h>

#include <array>
#include <vector>

#include "delio/places/stored_map.h"
#include "places/bytes.h"
#include "places/descriptor.h"
#include "target.h"

using namespace delio;

namespace {
constexpr std::size_t kHead = 52;

/** A part of a stored map as it says of itself where it lies. */
struct Part {
    std::uint64_t offset = 0, bytes = 0, unpacked = 0;
    std::uint32_t checksum = 0;
};

/** The file behind its head: parts that are packed, and whose checksums are right. */
class Parts {
 public:
    Part add(const std::string& plain) {
        uLongf size = compressBound(plain.size());
        std::string packed(size, '\0');
        auto* const to = reinterpret_cast<Bytef*>(packed.data());
        compress2(to, &size, reinterpret_cast<const Bytef*>(plain.data()), plain.size(), 1);
        const Part part{kHead + bytes_.size(), size, plain.size(),
                        static_cast<std::uint32_t>(crc32_z(0, to, size))};
        bytes_.append(packed, 0, size);
        return part;
    }
    const std::string& bytes() const { return bytes_; }

 private:
    std::string bytes_;
};

void put(ByteWriter& to, const Part& part) {
    to.put(part.offset);
    to.put(part.bytes);
    to.put(part.unpacked);
    to.put(part.checksum);
}

std::string textOf(const ByteWriter& bytes) { return {bytes.bytes().begin(), bytes.bytes().end()}; }

std::string take(std::string& from, std::size_t count) {
    const std::string taken = from.substr(0, count);
    from.erase(0, taken.size());
    return taken;
}

/** A map of the plain bytes of its parts: a byte for the version, the index (of one submap, up to
 *  the places of its parts), a descriptor, points, and the rest of the index, each behind its
 *  length of two bytes. */
std::string mapOf(std::string plain) {
    const std::string kind = take(plain, 1) + std::string(1, '\0');
    const std::uint32_t version = 1 + static_cast<std::uint8_t>(kind[0]) % StoredMap::kVersion;
    std::array<std::string, 4> parts;
    for (std::string& part : parts) {
        const std::string length = take(plain, 2) + std::string(2, '\0');
        part = take(plain, static_cast<std::uint8_t>(length[0]) +
                               256U * static_cast<std::uint8_t>(length[1]));
    }
    Parts packed;
    ByteWriter end, head;
    put(end, packed.add(parts[1]));
    put(end, packed.add(parts[2]));
    const Part index = packed.add(parts[0] + textOf(end) + parts[3]);
    for (const char letter : {'D', 'e', 'L', 'i', 'O', 'm', 'a', 'p'}) head.put(letter);
    head.put(version);
    put(head, index);
    head.put<std::uint64_t>(kHead + packed.bytes().size());
    head.put(static_cast<std::uint32_t>(crc32_z(0, head.bytes().data(), head.bytes().size())));
    return textOf(head) + packed.bytes();
}
}  // namespace

/** A map.delio; its checksums would hide all else, so that there is a kind with right ones. */
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::Input input(data, size);
    const bool plain = input.pick(2) == 1;
    const std::string file = fuzz::fileOf(plain ? mapOf(input.rest()) : input.rest(), "map.delio");
    return fuzz::mayRefuse([&] {
        const StoredMap map(file);
        for (const auto& drive : map.drives()) map.trajectory(drive);
        for (std::size_t i = 0; i < map.submaps().size(); ++i) map.descriptor(i);
        map.cloud(0.5);
    });
}
