#pragma once
#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

namespace delio::io {
/** Puts the fragments of IPv4 datagrams together, in whatever order they come. Datagrams that lack
 *  one are forgotten when there are too many of them: memory is bounded. */
class IpFragments {
 public:
    /** Source, destination, identification and protocol: fragments that share it belong together.
     */
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t, std::uint8_t>;

    /** A fragment `offset` bytes into the datagram; `last`: none follows it. Gives the datagram's
     *  content when that was the one that was missing. */
    std::optional<std::vector<std::uint8_t>> add(const Key& key, std::size_t offset, bool last,
                                                 const std::uint8_t* bytes, std::size_t count);

 private:
    struct Datagram {
        Key key;
        std::map<std::size_t, std::vector<std::uint8_t>> parts;
        std::size_t size = 0;  //!< 0: its end was not met yet
        std::size_t held = 0;  //!< bytes that came of it, again and again
    };
    static bool complete(const Datagram& datagram);

    std::list<Datagram> open_;
};
}  // namespace delio::io
