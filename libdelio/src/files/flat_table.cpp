#include "flat_table.h"

#include "delio/core/error.h"

namespace delio::io {
namespace {
constexpr std::size_t kSize = 4, kHead = 4;  // bytes of a length; of the sizes before the places
}

FlatTable FlatTable::root(std::string_view sized) {
    FlatTable none(sized, 0);
    const auto size = none.get<std::uint32_t>(0);
    if (size > sized.size() - kSize) throw Error("a FlatBuffer is cut off");
    const std::string_view buffer = sized.substr(kSize, size);
    const FlatTable begin(buffer, 0);
    return {buffer, begin.follow(0)};
}

FlatTable::FlatTable(std::string_view buffer, std::size_t at) : buffer_(buffer), at_(at) {
    if (at == 0) return;
    const auto back = get<std::int32_t>(at);
    const std::int64_t fields = static_cast<std::int64_t>(at) - back;
    if (fields < 0) throw Error("a FlatBuffer is damaged");
    fields_ = static_cast<std::size_t>(fields);
    fieldsBytes_ = get<std::uint16_t>(fields_);
    check(fields_, fieldsBytes_);
}

void FlatTable::check(std::size_t at, std::size_t bytes) const {
    if (at > buffer_.size() || bytes > buffer_.size() - at) throw Error("a FlatBuffer is damaged");
}

std::size_t FlatTable::placeOf(std::size_t field) const {
    const std::size_t entry = kHead + 2 * field;
    if (entry + 2 > fieldsBytes_) return 0;
    const auto offset = get<std::uint16_t>(fields_ + entry);
    return offset == 0 ? 0 : at_ + offset;
}

std::size_t FlatTable::follow(std::size_t at) const {
    const std::size_t to = at + get<std::uint32_t>(at);
    if (to == at) throw Error("a FlatBuffer is damaged");
    check(to, kSize);
    return to;
}

std::string_view FlatTable::vector(std::size_t field, std::size_t size) const {
    const std::size_t place = placeOf(field);
    if (place == 0) return {};
    const std::size_t at = follow(place);
    const std::size_t count = get<std::uint32_t>(at);
    check(at + kSize, count * size);
    return buffer_.substr(at + kSize, count * size);
}

std::vector<FlatTable> FlatTable::tables(std::size_t field) const {
    std::vector<FlatTable> tables;
    const std::size_t place = placeOf(field);
    if (place == 0) return tables;
    const std::size_t at = follow(place), count = get<std::uint32_t>(at);
    check(at + kSize, kSize * count);
    for (std::size_t i = 0; i < count; ++i)
        tables.push_back(FlatTable(buffer_, follow(at + kSize * (i + 1))));
    return tables;
}
}  // namespace delio::io
