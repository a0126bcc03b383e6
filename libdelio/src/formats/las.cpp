#include "las.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "delio/core/error.h"
#include "delio/files/output.h"
#include "delio/version.h"
#include "files/input_file.h"

namespace delio::io {
namespace {
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they lie here");

constexpr std::size_t kHeader10 = 227, kHeader14 = 375, kVariableHeader = 54, kExtra = 192,
                      kFormat6 = 30;
constexpr std::size_t kBlock = 4096;  // records that are read or written at once
constexpr std::uint16_t kGpsTimeBit = 1, kWktBit = 16;
constexpr std::uint16_t kWktRecord = 2112, kExtraRecord = 4;

/** Bytes of a record up to the end of what its format has, and where the time lies; 0: none. */
struct FormatOf {
    std::size_t bytes, timeAt;
};
constexpr FormatOf kFormats[] = {{20, 0},  {28, 20}, {26, 0},  {34, 20}, {57, 20}, {63, 20},
                                 {30, 22}, {36, 22}, {38, 22}, {59, 22}, {67, 22}};

/** LAS's numbers of the kinds, counted from 1. */
constexpr NumberKind kKinds[] = {NumberKind::kUint8,   NumberKind::kInt8,    NumberKind::kUint16,
                                 NumberKind::kInt16,   NumberKind::kUint32,  NumberKind::kInt32,
                                 NumberKind::kFloat64, NumberKind::kFloat64, NumberKind::kFloat32,
                                 NumberKind::kFloat64};
constexpr std::size_t kUint64 = 7, kInt64 = 8;  // of these there is no NumberKind

template <typename Number>
void put(std::vector<char>& bytes, std::size_t at, Number value) {
    std::memcpy(bytes.data() + at, &value, sizeof(value));
}

void putText(std::vector<char>& bytes, std::size_t at, const std::string& text, std::size_t most) {
    std::copy_n(text.begin(), std::min(text.size(), most), bytes.begin() + std::ptrdiff_t(at));
}

template <typename Number>
Number get(const char* bytes) {
    Number value;
    std::memcpy(&value, bytes, sizeof(value));
    return value;
}

template <typename Number>
double as(const std::uint8_t* from) {
    return static_cast<double>(get<Number>(reinterpret_cast<const char*>(from)));
}

template <typename Number>
void store(char* to, double value) {
    const auto number = static_cast<Number>(value);
    std::memcpy(to, &number, sizeof(number));
}

void storeNumber(char* to, NumberKind kind, double value) {
    switch (kind) {
        case NumberKind::kUint16:
            return store<std::uint16_t>(to, value);
        case NumberKind::kFloat32:
            return store<float>(to, value);
        default:
            return store<double>(to, value);
    }
}

std::size_t lasKindOf(NumberKind kind) {
    return kind == NumberKind::kUint16 ? 3 : kind == NumberKind::kFloat32 ? 9 : 10;
}

std::size_t writtenBytesOf(NumberKind kind) {
    return kind == NumberKind::kUint16 ? 2 : kind == NumberKind::kFloat32 ? 4 : 8;
}

/** A variable length record. */
std::vector<char> variableRecord(const std::string& user, std::uint16_t id,
                                 const std::string& description, const std::vector<char>& content) {
    std::vector<char> bytes(kVariableHeader + content.size());
    putText(bytes, 2, user, 16);
    put(bytes, 18, id);
    put(bytes, 20, static_cast<std::uint16_t>(content.size()));
    putText(bytes, 22, description, 31);
    std::copy(content.begin(), content.end(), bytes.begin() + kVariableHeader);
    return bytes;
}

std::vector<char> extrasRecord(const std::vector<LasExtra>& extras) {
    std::vector<char> content(extras.size() * kExtra);
    for (std::size_t i = 0; i < extras.size(); ++i) {
        const std::size_t at = i * kExtra;
        content[at + 2] = static_cast<char>(lasKindOf(extras[i].kind));
        putText(content, at + 4, extras[i].name, 31);
        putText(content, at + 160, extras[i].description, 31);
    }
    return variableRecord("LASF_Spec", kExtraRecord, "extra bytes", content);
}

std::vector<char> variableRecordsOf(const LasFile& file, std::uint32_t& count) {
    std::vector<char> bytes;
    const auto add = [&](const std::vector<char>& record) {
        bytes.insert(bytes.end(), record.begin(), record.end());
        ++count;
    };
    if (!file.extras.empty()) add(extrasRecord(file.extras));
    if (!file.wkt.empty())
        add(variableRecord("LASF_Projection", kWktRecord, "OGC coordinate system WKT",
                           {file.wkt.c_str(), file.wkt.c_str() + file.wkt.size() + 1}));
    return bytes;
}

/** How coordinates become whole numbers. */
struct Grid {
    double scale = 1e-4;
    Eigen::Vector3d offset = Eigen::Vector3d::Zero(), low = offset, high = offset;
};

Eigen::Array3d stepsOf(const Grid& grid, const Eigen::Vector3d& position) {
    return ((position - grid.offset).array() / grid.scale).round();
}

Grid gridOf(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const std::string& path) {
    constexpr double kMost = 2e9;  // steps to either side of the offset
    Grid grid;
    grid.offset = ((low + high) / 2).array().round();
    const double reach = (high - low).maxCoeff() / 2 + 1;
    if (reach > kMost * grid.scale) grid.scale = 1e-3;
    if (!(reach < kMost * grid.scale))
        throw Error("cannot write '" + path + "': the points lie too far apart for a LAS file");
    // Of the points as they are stored: programs compare.
    const auto stored = [&](const Eigen::Vector3d& position) -> Eigen::Vector3d {
        return grid.offset + grid.scale * stepsOf(grid, position).matrix();
    };
    grid.low = stored(low);
    grid.high = stored(high);
    return grid;
}

std::vector<char> headerOf(const LasFile& file, std::size_t count, const Grid& grid,
                           std::size_t recordBytes, std::size_t pointsAt, std::uint32_t records) {
    std::vector<char> bytes(kHeader14);
    putText(bytes, 0, "LASF", 4);
    put(bytes, 6, static_cast<std::uint16_t>(kWktBit | (file.gpsTime ? kGpsTimeBit : 0)));
    bytes[24] = 1;
    bytes[25] = 4;
    putText(bytes, 26, "OTHER", 31);
    putText(bytes, 58, std::string("DeLiO ") + kVersion, 31);
    put(bytes, 94, static_cast<std::uint16_t>(kHeader14));
    put(bytes, 96, static_cast<std::uint32_t>(pointsAt));
    put(bytes, 100, records);
    bytes[104] = 6;
    put(bytes, 105, static_cast<std::uint16_t>(recordBytes));
    for (int axis = 0; axis < 3; ++axis) {
        put(bytes, 131 + 8 * static_cast<std::size_t>(axis), grid.scale);
        put(bytes, 155 + 8 * static_cast<std::size_t>(axis), grid.offset[axis]);
        put(bytes, 179 + 16 * static_cast<std::size_t>(axis), grid.high[axis]);
        put(bytes, 187 + 16 * static_cast<std::size_t>(axis), grid.low[axis]);
    }
    put(bytes, 247, std::uint64_t{count});
    put(bytes, 255, std::uint64_t{count});  // all are first returns
    return bytes;
}

void storePoint(const LasFile& file, const Grid& grid, const LasPoint& point, char* to) {
    const Eigen::Array3d steps = stepsOf(grid, point.position);
    for (Eigen::Index axis = 0; axis < 3; ++axis) store<std::int32_t>(to + 4 * axis, steps[axis]);
    std::memcpy(to + 12, &point.intensity, sizeof(point.intensity));
    to[14] = 0x11;  // return 1 of 1
    to[16] = static_cast<char>(point.classification);
    std::memcpy(to + 22, &point.time_s, sizeof(point.time_s));
    std::size_t at = kFormat6;
    for (std::size_t i = 0; i < file.extras.size(); ++i) {
        storeNumber(to + at, file.extras[i].kind, point.extras[i]);
        at += writtenBytesOf(file.extras[i].kind);
    }
}

std::string textIn(const char* bytes, std::size_t most) {
    return {bytes, std::find(bytes, bytes + most, '\0')};
}
}  // namespace

double gpsTimeOf(double unix_s) {
    // Unix times at which a leap second came into force since 2006.
    constexpr double kLeaps[] = {1136073600, 1230768000, 1341100800, 1435708800, 1483228800};
    constexpr double kBefore2006_s = 13, kGpsEpoch_s = 315964800;
    double leap_s = kBefore2006_s;
    for (const double from : kLeaps)
        if (unix_s >= from) leap_s += 1;
    return unix_s - kGpsEpoch_s + leap_s - 1e9;
}

void saveLas(const LasFile& file, std::size_t count,
             const std::function<void(std::size_t i, LasPoint& point)>& pointAt,
             const std::string& path) {
    LasPoint point;
    point.extras.resize(file.extras.size());
    Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
    for (std::size_t i = 0; i < count; ++i) {
        pointAt(i, point);
        low = i == 0 ? point.position : low.cwiseMin(point.position);
        high = i == 0 ? point.position : high.cwiseMax(point.position);
    }
    const Grid grid = gridOf(low, high, path);
    std::size_t recordBytes = kFormat6;
    for (const auto& extra : file.extras) recordBytes += writtenBytesOf(extra.kind);
    std::uint32_t records = 0;
    const auto variable = variableRecordsOf(file, records);
    const auto header =
        headerOf(file, count, grid, recordBytes, kHeader14 + variable.size(), records);
    replaceFile(path, [&](const std::string& temporary) {
        std::ofstream out(temporary, std::ios::binary);
        out.write(header.data(), static_cast<std::streamsize>(header.size()));
        out.write(variable.data(), static_cast<std::streamsize>(variable.size()));
        std::vector<char> block;
        for (std::size_t begin = 0; begin < count && out; begin += kBlock) {
            const std::size_t end = std::min(begin + kBlock, count);
            block.assign((end - begin) * recordBytes, '\0');
            for (std::size_t i = begin; i < end; ++i) {
                pointAt(i, point);
                storePoint(file, grid, point, block.data() + (i - begin) * recordBytes);
            }
            out.write(block.data(), static_cast<std::streamsize>(block.size()));
        }
        out.close();
        return static_cast<bool>(out);
    });
}

LasReader::LasReader(const std::string& path) : file_(path, "LAS") {
    const std::size_t size = file_.bytesLeft();
    std::vector<char> bytes(std::min(size, kHeader14));
    file_.stream().read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!file_.stream() || bytes.size() < kHeader10 || std::string(bytes.data(), 4) != "LASF")
        file_.refuse("it does not begin with a LAS header");
    readHeader(bytes, size);
    const auto pointsAt = get<std::uint32_t>(&bytes[96]);
    readVariableRecords(get<std::uint16_t>(&bytes[94]), pointsAt, get<std::uint32_t>(&bytes[100]));
    file_.stream().clear();
    file_.stream().seekg(static_cast<std::streamoff>(pointsAt));
}

void LasReader::readHeader(const std::vector<char>& bytes, std::size_t size) {
    header_.minor = static_cast<std::uint8_t>(bytes[25]);
    if (bytes[24] != 1 || header_.minor > 4)
        file_.refuse("versions other than 1.0 to 1.4 are not supported");
    const auto headerBytes = get<std::uint16_t>(&bytes[94]);
    const auto pointsAt = get<std::uint32_t>(&bytes[96]);
    const bool is14 = header_.minor == 4;
    if (headerBytes < (is14 ? kHeader14 : kHeader10) || headerBytes > pointsAt || pointsAt > size ||
        (is14 && bytes.size() < kHeader14))
        file_.refuse("the sizes in its header contradict each other or the size of the file");
    const auto format = static_cast<std::uint8_t>(bytes[104]);
    if (format & 0xC0U)
        file_.refuse("compressed points (LAZ) are not supported; decompress it: laszip or pdal");
    header_.format = format;
    header_.recordBytes = get<std::uint16_t>(&bytes[105]);
    if (format >= std::size(kFormats) || header_.recordBytes < kFormats[format].bytes)
        file_.refuse("its point format " + std::to_string(format) + " of " +
                     std::to_string(header_.recordBytes) + " bytes is not known");
    if (kFormats[format].timeAt > 0) header_.timeAt = kFormats[format].timeAt;
    const auto global = get<std::uint16_t>(&bytes[6]);
    header_.gpsTime = (global & kGpsTimeBit) != 0;
    const std::uint64_t count =
        is14 ? get<std::uint64_t>(&bytes[247]) : get<std::uint32_t>(&bytes[107]);
    const std::size_t whole = (size - pointsAt) / header_.recordBytes;
    if (count > whole) file_.refuseCut(whole, static_cast<std::size_t>(count));
    header_.count = static_cast<std::size_t>(count);
    for (int axis = 0; axis < 3; ++axis) {
        header_.scale[axis] = get<double>(&bytes[131 + 8 * static_cast<std::size_t>(axis)]);
        header_.offset[axis] = get<double>(&bytes[155 + 8 * static_cast<std::size_t>(axis)]);
    }
    constexpr double kFarthest_m = 1e9;
    if (!header_.scale.allFinite() || !header_.offset.allFinite() ||
        header_.scale.cwiseAbs().maxCoeff() > 1e3 || header_.scale.cwiseAbs().minCoeff() <= 0 ||
        header_.offset.cwiseAbs().maxCoeff() > kFarthest_m)
        file_.refuse("its scale or offset is not plausible");
}

void LasReader::readVariableRecords(std::size_t headerBytes, std::size_t pointsAt,
                                    std::size_t records) {
    std::size_t at = headerBytes;
    std::vector<char> head(kVariableHeader), content;
    for (std::size_t i = 0; i < records; ++i) {
        if (pointsAt - at < kVariableHeader)
            file_.refuse("its variable records reach beyond their end");
        file_.stream().clear();
        file_.stream().seekg(static_cast<std::streamoff>(at));
        file_.stream().read(head.data(), static_cast<std::streamsize>(head.size()));
        at += kVariableHeader;
        const std::size_t length = get<std::uint16_t>(&head[20]);
        if (!file_.stream() || pointsAt - at < length)
            file_.refuse("its variable records reach beyond their end");
        content.resize(length);
        file_.stream().read(content.data(), static_cast<std::streamsize>(length));
        if (!file_.stream()) file_.refuse("its variable records are cut off");
        at += length;
        const std::string user = textIn(&head[2], 16);
        const auto id = get<std::uint16_t>(&head[18]);
        if (user == "LASF_Projection" && id == kWktRecord)
            header_.wkt = textIn(content.data(), content.size());
        if (user == "LASF_Spec" && id == kExtraRecord) takeExtras(content);
    }
}

/** Extras lie behind what the format has, one after the other. */
void LasReader::takeExtras(const std::vector<char>& bytes) {
    header_.extras.clear();
    std::size_t offset = kFormats[header_.format].bytes;
    for (std::size_t at = 0; at + kExtra <= bytes.size(); at += kExtra) {
        const auto type = static_cast<std::uint8_t>(bytes[at + 2]);
        if (type == 0 || type > std::size(kKinds)) return;  // raw bytes, or something of the future
        const NumberKind kind = kKinds[type - 1U];
        const std::size_t size = bytesOf(kind);
        if (offset + size > header_.recordBytes) return;
        if (type != kUint64 && type != kInt64)
            header_.extras.push_back({plainName(textIn(&bytes[at + 4], 32)), offset, kind});
        offset += size;
    }
}

void LasReader::forEach(const std::function<void(const std::uint8_t* record)>& take) {
    std::vector<std::uint8_t> block(kBlock * header_.recordBytes);
    for (std::size_t done = 0; done < header_.count;) {
        const std::size_t wanted = std::min(kBlock, header_.count - done);
        file_.stream().read(reinterpret_cast<char*>(block.data()),
                            static_cast<std::streamsize>(wanted * header_.recordBytes));
        if (!file_.stream()) file_.refuseCut(done, header_.count);
        for (std::size_t i = 0; i < wanted; ++i) take(&block[i * header_.recordBytes]);
        done += wanted;
    }
}

Eigen::Vector3d LasReader::position(const std::uint8_t* record) const {
    const Eigen::Vector3d steps(as<std::int32_t>(record), as<std::int32_t>(record + 4),
                                as<std::int32_t>(record + 8));
    return header_.scale.cwiseProduct(steps) + header_.offset;
}

double numberAt(const std::uint8_t* from, NumberKind kind) {
    switch (kind) {
        case NumberKind::kInt8:
            return as<std::int8_t>(from);
        case NumberKind::kUint8:
            return as<std::uint8_t>(from);
        case NumberKind::kInt16:
            return as<std::int16_t>(from);
        case NumberKind::kUint16:
            return as<std::uint16_t>(from);
        case NumberKind::kInt32:
            return as<std::int32_t>(from);
        case NumberKind::kUint32:
            return as<std::uint32_t>(from);
        case NumberKind::kFloat32:
            return as<float>(from);
        case NumberKind::kFloat64:
            return as<double>(from);
    }
    return 0;
}

CloudRecords readLasScan(const std::string& path) {
    LasReader las(path);
    const LasHeader& header = las.header();
    std::vector<std::string> names{"x", "y", "z", "intensity"};
    if (header.timeAt) names.push_back("time");
    for (const auto& extra : header.extras) names.push_back(extra.name);
    CloudRecords records{layoutOfDoubles(names), {}, header.count, 1};
    if (header.count > kMostBytes / records.layout.step)
        throw Error("'" + path + "' is too large for one scan");
    records.bytes.resize(header.count * records.layout.step);
    std::uint8_t* to = records.bytes.data();
    const auto add = [&](double value) {
        std::memcpy(to, &value, sizeof(value));
        to += sizeof(value);
    };
    las.forEach([&](const std::uint8_t* record) {
        const Eigen::Vector3d position = las.position(record);
        for (int axis = 0; axis < 3; ++axis) add(position[axis]);
        add(numberAt(record + 12, NumberKind::kUint16));
        if (header.timeAt) add(numberAt(record + *header.timeAt, NumberKind::kFloat64));
        for (const auto& extra : header.extras) add(numberAt(record + extra.offset, extra.kind));
    });
    return records;
}
}  // namespace delio::io
