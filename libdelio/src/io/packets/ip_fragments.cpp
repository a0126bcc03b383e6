#include "ip_fragments.h"

#include <algorithm>

namespace delio::io {
namespace {
constexpr std::size_t kMostOpen = 32;
constexpr std::size_t kLargest = 65535;          // bytes of a datagram
constexpr std::size_t kMostHeld = 4 * kLargest;  // of one, sent again some times
}  // namespace

bool IpFragments::complete(const Datagram& datagram) {
    if (datagram.size == 0) return false;
    std::size_t covered = 0;
    for (const auto& [offset, bytes] : datagram.parts) {
        if (offset > covered) return false;
        covered = std::max(covered, offset + bytes.size());
    }
    return covered >= datagram.size;
}

std::optional<std::vector<std::uint8_t>> IpFragments::add(const Key& key, std::size_t offset,
                                                          bool last, const std::uint8_t* bytes,
                                                          std::size_t count) {
    if (count == 0 || offset + count > kLargest) return {};
    auto found = std::find_if(open_.begin(), open_.end(),
                              [&](const Datagram& datagram) { return datagram.key == key; });
    if (found == open_.end()) {
        if (open_.size() == kMostOpen) open_.pop_front();
        open_.push_back({key, {}, 0});
        found = std::prev(open_.end());
    }
    found->parts[offset].assign(bytes, bytes + count);
    found->held += count;
    if (found->held > kMostHeld) {  // parts that overlap for ever make no datagram
        open_.erase(found);
        return {};
    }
    if (last) found->size = offset + count;
    if (!complete(*found)) return {};
    std::vector<std::uint8_t> whole(found->size);
    for (const auto& [at, part] : found->parts) {
        if (at >= whole.size()) break;
        const std::size_t used = std::min(part.size(), whole.size() - at);
        std::copy_n(part.begin(), used, whole.begin() + static_cast<std::ptrdiff_t>(at));
    }
    open_.erase(found);
    return whole;
}
}  // namespace delio::io
