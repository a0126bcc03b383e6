#pragma once
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

namespace delio::io {
/** A table of a FlatBuffer, whose fields are known by their numbers. No offset is trusted: what
 * lies outside of the buffer is an Error. The buffer has to live on. */
class FlatTable {
 public:
    /** The root table of a buffer that begins with its size (four bytes). */
    static FlatTable root(std::string_view sized);

    template <typename Number>
    Number number(std::size_t field, Number otherwise = 0) const {
        static_assert(std::is_arithmetic_v<Number>);
        const std::size_t at = placeOf(field);
        return at == 0 ? otherwise : get<Number>(at);
    }
    /** A text, or bytes; empty where the field is missing. */
    std::string_view bytes(std::size_t field) const { return vector(field, 1); }
    /** Records of `size` bytes that lie side by side. */
    std::string_view records(std::size_t field, std::size_t size) const {
        return vector(field, size);
    }
    template <typename Number>
    std::vector<Number> numbers(std::size_t field) const {
        const std::string_view raw = vector(field, sizeof(Number));
        std::vector<Number> numbers(raw.size() / sizeof(Number));
        if (!raw.empty()) std::memcpy(numbers.data(), raw.data(), raw.size());
        return numbers;
    }
    /** A vector of tables. */
    std::vector<FlatTable> tables(std::size_t field) const;

 private:
    FlatTable(std::string_view buffer, std::size_t at);

    template <typename Number>
    Number get(std::size_t at) const {
        check(at, sizeof(Number));
        Number number;
        std::memcpy(&number, buffer_.data() + at, sizeof(number));
        return number;
    }
    void check(std::size_t at, std::size_t bytes) const;
    /** 0: the field is missing. */
    std::size_t placeOf(std::size_t field) const;
    /** Where an offset points to. */
    std::size_t follow(std::size_t at) const;
    std::string_view vector(std::size_t field, std::size_t size) const;

    std::string_view buffer_;
    std::size_t at_ = 0, fields_ = 0;  //!< of the table, of the places of its fields
    std::size_t fieldsBytes_ = 0;
};
}  // namespace delio::io
