#include "point_records.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <locale>

#include "delio/core/error.h"
#include "files/input_file.h"
#include "number_line.h"

namespace delio::io {
namespace {
NumberKind kindOf(const Column& column) {
    switch (column.kind) {
        case 'F':
            return column.bytes == 4 ? NumberKind::kFloat32 : NumberKind::kFloat64;
        case 'U':
            return column.bytes == 1   ? NumberKind::kUint8
                   : column.bytes == 2 ? NumberKind::kUint16
                   : column.bytes == 4 ? NumberKind::kUint32
                                       : NumberKind::kFloat64;  // see makeDoubles()
        default:
            return column.bytes == 1   ? NumberKind::kInt8
                   : column.bytes == 2 ? NumberKind::kInt16
                   : column.bytes == 4 ? NumberKind::kInt32
                                       : NumberKind::kFloat64;
    }
}

template <typename Whole>
void makeDouble(std::uint8_t* bytes) {
    Whole whole;
    std::memcpy(&whole, bytes, sizeof(whole));
    const auto value = static_cast<double>(whole);
    std::memcpy(bytes, &value, sizeof(value));
}

/** The rest of a file as a text. */
std::string restOf(RecordFile& file, std::size_t bytes) {
    std::string text(bytes, '\0');
    file.stream().read(text.data(), static_cast<std::streamsize>(bytes));
    text.resize(static_cast<std::size_t>(file.stream().gcount()));
    return text;
}

/** Columns before the last ones of one byte each. Some programs write these as raw characters. */
std::size_t leadOf(const std::vector<Column>& columns) {
    std::size_t lead = columns.size();
    while (lead > 0 && columns[lead - 1].bytes == 1) --lead;
    return lead;
}

/** Takes a line of numbers off `rest`; false where it is something else. */
bool takeNumbers(std::string_view& rest, std::vector<double>& values, std::size_t width) {
    const auto line = nextLine(rest);
    return line && numbersIn(*line, values) == width;
}

/** The same of a line whose numbers are followed by raw characters, a space before each. A line end
 *  may be one of them. */
bool takeCharacters(std::string_view& rest, std::vector<double>& values,
                    const std::vector<Column>& columns, std::size_t lead) {
    constexpr std::string_view kBlanks = " \t\r\n";
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    std::size_t end = 0;
    for (std::size_t i = 0; i < lead; ++i) {
        end = rest.find_first_not_of(kBlanks, end);
        if (end == rest.npos) return false;
        end = rest.find_first_of(kBlanks, end);
        if (end == rest.npos) return false;
    }
    const std::size_t tail = columns.size() - lead;
    if (numbersIn(rest.substr(0, end), values) != lead || rest.size() - end < 2 * tail)
        return false;
    for (std::size_t i = 0; i < tail; ++i) {
        if (rest[end + 2 * i] != ' ') return false;
        const auto character = static_cast<std::uint8_t>(rest[end + 2 * i + 1]);
        values[lead + i] =
            columns[lead + i].kind == 'I' ? static_cast<std::int8_t>(character) : character;
    }
    rest.remove_prefix(end + 2 * tail);
    const auto line = rest.find_first_not_of(" \r");
    return line == rest.npos || rest[line] == '\n';
}

CloudRecords readLines(RecordFile& file, const std::vector<Column>& columns, std::size_t count) {
    std::vector<std::string> names;
    names.reserve(columns.size());
    for (const auto& column : columns) names.push_back(column.name);
    CloudRecords records{layoutOfDoubles(names), {}, count, 1};
    const std::size_t width = columns.size(), lead = leadOf(columns);
    const std::size_t left = file.bytesLeft();
    // A digit and a space or line end make a number.
    if (width == 0 || count > (left + 1) / (2 * width)) file.refuseCut(0, count);
    const std::string text = restOf(file, left);
    records.bytes.resize(count * records.layout.step);
    std::vector<double> values(width + 1);
    const auto readWith = [&](const auto& take) {
        std::string_view rest = text;
        std::size_t done = 0;
        for (; done < count && take(rest); ++done)
            std::memcpy(&records.bytes[done * records.layout.step], values.data(),
                        records.layout.step);
        return done;
    };
    std::size_t done = readWith([&](auto& rest) { return takeNumbers(rest, values, width); });
    if (done < count && lead > 0 && lead < width)
        done = std::max(done, readWith([&](auto& rest) {
                            return takeCharacters(rest, values, columns, lead);
                        }));
    if (done < count) file.refuseCut(done, count);
    return records;
}
}  // namespace

std::size_t bytesOf(NumberKind kind) {
    switch (kind) {
        case NumberKind::kInt8:
        case NumberKind::kUint8:
            return 1;
        case NumberKind::kInt16:
        case NumberKind::kUint16:
            return 2;
        case NumberKind::kInt32:
        case NumberKind::kUint32:
        case NumberKind::kFloat32:
            return 4;
        case NumberKind::kFloat64:
            return 8;
    }
    return 0;
}

std::string plainName(std::string name) {
    name.erase(std::remove_if(name.begin(), name.end(),
                              [](char c) { return c == '"' || c == '\'' || c == '/'; }),
               name.end());
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const std::string scalar = "scalar_";  // CloudCompare
    return name.rfind(scalar, 0) == 0 ? name.substr(scalar.size()) : name;
}

PointLayout layoutOf(const std::vector<Column>& columns) {
    PointLayout layout;
    for (const auto& column : columns) {
        const std::string name = plainName(column.name);
        if (!name.empty() && name != "_")
            layout.fields.push_back({name, layout.step, kindOf(column)});
        layout.step += column.bytes;
    }
    return layout;
}

PointLayout layoutOfDoubles(const std::vector<std::string>& names) {
    std::vector<Column> columns;
    columns.reserve(names.size());
    for (const auto& name : names) columns.push_back({name, 'F', 8});
    return layoutOf(columns);
}

void makeDoubles(const std::vector<Column>& columns, CloudRecords& records) {
    std::size_t offset = 0;
    for (const auto& column : columns) {
        const auto make = column.kind == 'U' ? makeDouble<std::uint64_t> : makeDouble<std::int64_t>;
        if (column.kind != 'F' && column.bytes == 8)
            for (std::size_t i = 0; i < records.count; ++i)
                make(&records.bytes[i * records.layout.step + offset]);
        offset += column.bytes;
    }
}

CloudRecords readRecords(RecordFile& file, const std::vector<Column>& columns, std::size_t count,
                         bool ascii) {
    if (ascii) return readLines(file, columns, count);
    CloudRecords records{layoutOf(columns), {}, count, 1};
    const std::size_t step = records.layout.step;
    const std::size_t whole = step == 0 ? 0 : file.bytesLeft() / step;
    if (step == 0 || count > whole) file.refuseCut(whole, count);
    if (count * step > kMostBytes) file.refuse("the file is too large for one scan");
    records.bytes.resize(count * step);
    file.stream().read(reinterpret_cast<char*>(records.bytes.data()),
                       static_cast<std::streamsize>(records.bytes.size()));
    if (!file.stream()) file.refuseCut(0, count);
    makeDoubles(columns, records);
    return records;
}

bool isNumber(char kind, std::size_t bytes) {
    if (kind == 'F') return bytes == 4 || bytes == 8;
    return (kind == 'U' || kind == 'I') && (bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8);
}

std::size_t strideOf(const std::vector<Column>& columns) {
    std::size_t stride = 0;
    for (const auto& column : columns) stride += column.bytes;
    return stride;
}

RecordFile::RecordFile(const std::string& path, std::string kind)
    : path_(path), kind_(std::move(kind)), in_(path, std::ios::binary) {
    if (!in_) throw Error("cannot read '" + path + "': no such file");
    in_.imbue(std::locale::classic());
}

void RecordFile::refuse(const std::string& why) const {
    throw Error("'" + path_ + "' is not a " + kind_ + ": " + why);
}

void RecordFile::refuseCut(std::size_t done, std::size_t count) const {
    refuse("cut off or malformed after " + std::to_string(done) + " of " + std::to_string(count) +
           " points");
}

std::size_t RecordFile::bytesLeft() {
    const auto here = in_.tellg();
    in_.seekg(0, std::ios::end);
    const auto end = in_.tellg();
    in_.clear();
    if (here < 0 || end < here) return 0;
    in_.seekg(here);
    return static_cast<std::size_t>(end - here);
}
}  // namespace delio::io
