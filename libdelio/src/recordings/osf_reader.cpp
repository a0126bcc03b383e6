#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "byte_input.h"
#include "delio/core/error.h"
#include "field_image.h"
#include "files/flat_table.h"
#include "imu_samples.h"
#include "ouster.h"
#include "sources.h"

namespace delio::io {
namespace {
/** Numbers of the fields in the tables of Ouster's OSF, version 2. */
namespace header {
enum Field : std::uint8_t { kVersion, kStatus, kMetadataAt, kFileBytes };
constexpr std::uint8_t kFinished = 2;
}  // namespace header
namespace metadata {
enum Field : std::uint8_t { kEntries = 4 };
enum EntryField : std::uint8_t { kId, kType, kBuffer };
}  // namespace metadata
namespace chunk {
enum Field : std::uint8_t { kMessages };
enum MessageField : std::uint8_t { kTime, kStream, kBuffer };
}  // namespace chunk
namespace turn {
enum Field : std::uint8_t { kImages, kKinds, kTimes, kStatuses = 4, kNumber, kReceived = 7, kMore };
enum FieldOfMore : std::uint8_t { kName, kData = 4 };
enum Kind : std::uint8_t { kRange = 1, kReflectivity = 5 };
}  // namespace turn

/** A sensor and its stream of turns. */
struct Stream {
    std::uint32_t id = 0;
    std::string label;  //!< its serial number, or that of its description
    std::string json;
};

std::string_view textOf(const std::vector<std::uint8_t>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <typename Number>
std::vector<Number> numbersOf(std::string_view bytes) {
    std::vector<Number> numbers(bytes.size() / sizeof(Number));
    if (!numbers.empty())
        std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
    return numbers;
}

/** Floats that are coded as an image of their bits, three in a row. */
std::vector<Eigen::Vector3f> vectorsOf(std::string_view coded, std::size_t rows) {
    const auto bits = fieldImageOf(coded, rows, 3).pixels;
    std::vector<Eigen::Vector3f> vectors(rows);
    for (std::size_t i = 0; i < rows; ++i)
        std::memcpy(vectors[i].data(), &bits[3 * i], 3 * sizeof(float));
    return vectors;
}

class OsfReader : public ScanReader {
 public:
    explicit OsfReader(const ScanSource& source);

    std::optional<Scan> next() override;
    bool skip() override { return next().has_value(); }
    std::vector<ImuSample> takeImu() override { return maker_->takeImu(imu_); }
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return others_; }
    std::optional<double> fraction() const override {
        return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
    }
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override;

 private:
    std::string named() const { return "'" + source_.path + "'"; }
    /** The next block: a FlatBuffer behind its size, before its checksum. */
    void readBlock();
    void readHeader();
    std::vector<Stream> readStreams();
    void choose(const std::vector<Stream>& streams);
    /** Reads on until there are messages of the stream; false at the end. */
    bool readMessages();
    OusterFrame frameOf(std::string_view message) const;
    /** Samples of firmware 3.2 and later, in m/s^2 and rad/s. */
    void readImu(const FlatTable& turn);
    void readImages(const FlatTable& turn, OusterFrame& frame) const;
    void place(const FieldImage& image, std::uint8_t kind, OusterFrame& frame) const;

    ScanSource source_;
    FileInput file_;
    std::uint64_t begin_ = 0, end_ = 0;  //!< of the chunks
    std::vector<std::uint8_t> block_;
    std::vector<FlatTable> messages_;  //!< of the block, the last one first
    std::uint32_t stream_ = 0;
    std::string label_;
    std::set<std::string> others_;
    std::optional<OusterInfo> info_;
    std::optional<OusterScans> maker_;
    std::optional<DriveMeta> meta_;
    std::size_t turns_ = 0;       //!< met so far, scans or not
    std::vector<OusterImu> imu_;  //!< that nobody took yet
    bool pointTimes_ = false, hasImu_ = false, ended_ = false;
};

OsfReader::OsfReader(const ScanSource& source) : source_(source), file_(source.path) {
    try {
        readHeader();
        choose(readStreams());
    } catch (const Error& e) {
        throw Error(named() + ": " + e.what());
    }
    meta_.emplace();
    meta_->motionCompensated = false;
}

void OsfReader::readBlock() {
    constexpr std::size_t kSize = 4, kSum = 4;
    const auto bytes = file_.number<std::uint32_t>();
    if (bytes + kSum > file_.left())
        throw Error("is cut off at byte " + std::to_string(file_.size()));
    file_.seek(file_.position() - kSize);
    file_.read(block_, kSize + std::uint64_t{bytes});
    const auto sum = file_.number<std::uint32_t>();
    if (sum != crc32_z(0, block_.data(), block_.size()))
        throw Error("is damaged before byte " + std::to_string(file_.position()) +
                    ": wrong checksum");
}

void OsfReader::readHeader() {
    constexpr std::uint64_t kVersion2 = 20, kMajorAt = 48;
    readBlock();
    const FlatTable table = FlatTable::root(textOf(block_));
    const auto version = table.number<std::uint64_t>(header::kVersion);
    if (version < kVersion2 || version >> kMajorAt > 2)
        throw Error("is an OSF of another version than 2; save it again with Ouster's tools");
    if (table.number<std::uint8_t>(header::kStatus) != header::kFinished)
        throw Error("was not finished by its recorder; repair it with Ouster's tools");
    begin_ = file_.position();
    end_ = table.number<std::uint64_t>(header::kMetadataAt, 1);
    if (end_ < begin_ || end_ >= file_.size())
        throw Error("is cut off at byte " + std::to_string(file_.size()));
}

std::vector<Stream> OsfReader::readStreams() {
    file_.seek(end_);
    readBlock();
    std::map<std::uint32_t, std::string> jsons;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;  // of a stream, of its sensor
    for (const FlatTable& entry : FlatTable::root(textOf(block_)).tables(metadata::kEntries)) {
        const auto id = entry.number<std::uint32_t>(metadata::kId);
        const std::string_view type = entry.bytes(metadata::kType);
        const std::string_view buffer = entry.bytes(metadata::kBuffer);
        if (type == "ouster/v1/os_sensor/LidarSensor") jsons[id] = FlatTable::root(buffer).bytes(0);
        if (type == "ouster/v1/os_sensor/LidarScanStream")
            found.emplace_back(id, FlatTable::root(buffer).number<std::uint32_t>(0));
    }
    file_.seek(begin_);
    std::vector<Stream> streams;
    for (const auto& [id, sensor] : found) {
        const auto json = jsons.find(sensor);
        if (json == jsons.end()) throw Error("describes no sensor of its stream of scans");
        const auto serial = readOusterInfo(json->second, "its metadata").ids.serial;
        streams.push_back({id, std::to_string(serial > 0 ? serial : sensor), json->second});
    }
    if (streams.empty()) throw Error("contains no scans of a LiDAR");
    return streams;
}

void OsfReader::choose(const std::vector<Stream>& streams) {
    const auto chosen = std::find_if(streams.begin(), streams.end(), [&](const Stream& stream) {
        return source_.label.empty() || source_.label == stream.label;
    });
    for (const Stream& stream : streams)
        if (chosen == streams.end() || stream.id != chosen->id) others_.insert(stream.label);
    if (chosen == streams.end()) {
        std::string seen;
        for (const std::string& other : others_) seen += (seen.empty() ? "" : ", ") + other;
        throw Error("contains no sensor '" + source_.label + "'; it contains " + seen);
    }
    stream_ = chosen->id;
    label_ = chosen->label;
    info_ = readOusterInfo(chosen->json, "its metadata");
    maker_.emplace(*info_);
}

bool OsfReader::readMessages() {
    while (messages_.empty() && file_.position() < end_) {
        readBlock();
        for (const FlatTable& message : FlatTable::root(textOf(block_)).tables(chunk::kMessages))
            if (message.number<std::uint32_t>(chunk::kStream) == stream_)
                messages_.push_back(message);
        std::reverse(messages_.begin(), messages_.end());
    }
    return !messages_.empty();
}

/** A row of a shifted image begins so many columns later than the sensor's. */
void OsfReader::place(const FieldImage& image, std::uint8_t kind, OusterFrame& frame) const {
    if (image.isShifted && info_->pixelShifts.empty())
        throw Error("its metadata: pixel_shift_by_row is missing");
    const auto columns = static_cast<std::ptrdiff_t>(info_->columns);
    for (std::size_t row = 0; row < info_->rows; ++row) {
        const std::ptrdiff_t shift =
            image.isShifted ? info_->pixelShifts[row] % columns + columns : 0;
        for (std::size_t column = 0; column < info_->columns; ++column) {
            if (!frame.received[column]) continue;
            const auto from = (static_cast<std::ptrdiff_t>(column) + shift) % columns;
            const std::uint32_t value =
                image.pixels[row * info_->columns + static_cast<std::size_t>(from)];
            const std::size_t to = column * info_->rows + row;
            if (kind == turn::kRange)
                frame.ranges_mm[to] = value;
            else
                frame.reflectivities[to] = static_cast<std::uint8_t>(std::min(255U, value));
        }
    }
}

void OsfReader::readImages(const FlatTable& turn, OusterFrame& frame) const {
    constexpr std::size_t kKindBytes = 2;  // kind, type of its numbers
    const std::string_view kinds = turn.records(turn::kKinds, kKindBytes);
    const auto images = turn.tables(turn::kImages);
    bool hasRange = false;
    for (std::size_t i = 0; i < std::min(images.size(), kinds.size() / kKindBytes); ++i) {
        const auto kind = static_cast<std::uint8_t>(kinds[kKindBytes * i]);
        if (kind != turn::kRange && kind != turn::kReflectivity) continue;
        hasRange = hasRange || kind == turn::kRange;
        place(fieldImageOf(images[i].bytes(0), info_->rows, info_->columns), kind, frame);
    }
    if (!hasRange) throw Error("a turn has no ranges");
}

OusterFrame OsfReader::frameOf(std::string_view message) const {
    const FlatTable table = FlatTable::root(message);
    OusterFrame frame(*info_);
    frame.number = static_cast<std::uint16_t>(table.number<std::int32_t>(turn::kNumber));
    const auto statuses = table.numbers<std::uint32_t>(turn::kStatuses);
    frame.times_ns = table.numbers<std::uint64_t>(turn::kTimes);
    if (statuses.size() != info_->columns || frame.times_ns.size() != info_->columns)
        throw Error("a turn has another number of columns than its sensor");
    for (std::size_t column = 0; column < statuses.size(); ++column) {
        frame.received[column] = (statuses[column] & 1U) != 0;
        frame.count += frame.received[column] ? 1 : 0;
    }
    const auto received_ns = table.numbers<std::uint64_t>(turn::kReceived);
    const auto first = std::find_if(received_ns.begin(), received_ns.end(),
                                    [](std::uint64_t time_ns) { return time_ns > 0; });
    if (first != received_ns.end()) frame.received_s = 1e-9 * static_cast<double>(*first);
    readImages(table, frame);
    return frame;
}

void OsfReader::readImu(const FlatTable& turn) {
    std::map<std::string_view, std::string_view> fields;
    for (const FlatTable& field : turn.tables(turn::kMore))
        fields[field.bytes(turn::kName)] = field.bytes(turn::kData);
    const std::string_view rate = fields["IMU_GYRO"], acceleration = fields["IMU_ACC"];
    const auto times_ns = numbersOf<std::uint64_t>(fields["IMU_TIMESTAMP"]);
    const auto statuses = numbersOf<std::uint16_t>(fields["IMU_STATUS"]);
    if (rate.empty() || acceleration.empty() || statuses.size() != times_ns.size()) return;
    const auto rates = vectorsOf(rate, times_ns.size()),
               accelerations = vectorsOf(acceleration, times_ns.size());
    for (std::size_t i = 0; i < times_ns.size(); ++i) {
        if ((statuses[i] & 1U) == 0) continue;  // it was not received
        addSample(OusterImu{times_ns[i], accelerations[i].cast<double>(), rates[i].cast<double>()},
                  imu_);
        hasImu_ = true;
    }
}

std::optional<Scan> OsfReader::next() {
    try {
        while (!ended_ && readMessages()) {
            const FlatTable message = messages_.back();
            messages_.pop_back();
            ++turns_;
            const std::string_view turn = message.bytes(chunk::kBuffer);
            readImu(FlatTable::root(turn));
            OusterFrame frame = frameOf(turn);
            if (frame.received_s == 0)
                frame.received_s =
                    1e-9 * static_cast<double>(message.number<std::uint64_t>(chunk::kTime));
            // Less than half a turn is no scan, as at the begin and end of packets.
            if (2 * frame.count < info_->columnsUsed) continue;
            Scan scan = maker_->scanOf(frame);
            scan.index = maker_->made() - 1;
            pointTimes_ = pointTimes_ || !scan.times_s.empty();
            return scan;
        }
        if (!ended_ && maker_->made() == 0)
            throw Error("contains no scan; turns with less than half of their columns: " +
                        std::to_string(turns_));
        ended_ = true;
        return {};
    } catch (const Error& e) {
        ended_ = true;
        throw Error(named() + ": " + e.what());
    }
}

Recording OsfReader::recording() const {
    Recording recording;
    recording.kind = "OSF";
    recording.sensor = info_->sensor();
    recording.pointTimes = pointTimes_;
    recording.motionCompensated = false;
    if (hasImu_) recording.imu = "with the turns";
    recording.findings = maker_->findings();
    return recording;
}
}  // namespace

std::unique_ptr<ScanReader> openOsf(const ScanSource& source) {
    return std::make_unique<OsfReader>(source);
}
}  // namespace delio::io
