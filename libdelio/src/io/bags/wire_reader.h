#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "message_source.h"

namespace delio::io {
/** Reads the fields of a message in their order, as ROS 1 (little-endian, packed) or ROS 2 (CDR:
 *  either byte order, numbers aligned to their size) writes them. Throws Error, which does not name
 *  the file, for lengths beyond the message and for other encodings. */
class WireReader {
 public:
    WireReader(const Bytes& message, Encoding encoding);
    explicit WireReader(const Message& message) : WireReader(message.bytes, message.encoding) {}

    bool ros1() const { return ros1_; }

    template <typename Number>
    Number number() {
        static_assert(std::is_unsigned_v<Number>);
        if (!ros1_) at_ += (sizeof(Number) - at_ % sizeof(Number)) % sizeof(Number);
        const std::uint8_t* from = bytes(sizeof(Number)).data;
        Number value = 0;
        for (std::size_t i = 0; i < sizeof(Number); ++i) {
            const std::size_t place = bigEndian_ ? sizeof(Number) - 1 - i : i;
            value = static_cast<Number>(value | Number{from[i]} << (8 * place));
        }
        return value;
    }
    std::string text();
    /** `count` bytes in a row. */
    Bytes bytes(std::size_t count);
    /** An array of bytes behind its length. */
    Bytes byteArray() { return bytes(number<std::uint32_t>()); }
    /** A length of records that have at least `least` bytes each. */
    std::size_t length(std::size_t least);
    /** Seconds of a time. */
    double time();
    /** std_msgs/Header: its stamp, in seconds. */
    double header();

 private:
    const std::uint8_t* data_;
    std::size_t size_, at_ = 0;
    bool ros1_, bigEndian_ = false;
};
}  // namespace delio::io
