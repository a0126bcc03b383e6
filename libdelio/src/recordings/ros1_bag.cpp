#include <algorithm>
#include <cstdint>
#include <map>

#include "byte_input.h"
#include "delio/core/error.h"
#include "message_source.h"

namespace delio::io {
namespace {
/** Reads a ROS 1 bag, version 2.0, record by record from its begin: bags that were cut off or never
 *  indexed (.bag.active) are read as far as they go. Chunks may be compressed with bz2 or lz4. */
class Ros1Bag : public MessageSource {
 public:
    /** Throws Error if it cannot be opened or is no such bag. */
    explicit Ros1Bag(const std::string& path);

    /** Throws Error where the bag is cut off; a bag that was never indexed ends where its last
     *  record does. */
    std::optional<Message> next() override;
    double fraction() const override;

 private:
    using Fields = std::map<std::string, std::string>;
    struct Connection {
        std::string topic, type;
    };
    /** A record up to its data. */
    struct Record {
        Fields fields;
        std::uint8_t op = 0;
        std::uint32_t bytes = 0;  //!< of its data, which is next
    };

    void rewind();
    Record readRecord(ByteInput& in);
    void readConnection(const Record& record, ByteInput& in);
    void enterChunk(const Record& record);
    std::optional<Message> readMessage(const Record& record, ByteInput& in);
    void readBagHeader(const Record& record);
    void checkEnd() const;
    /** False where there is no whole index. */
    bool listByIndex();
    void listByFirstChunks();

    FileInput file_;
    MemoryInput chunk_;           //!< the chunk that is read, if it is compressed
    std::uint64_t chunkEnd_ = 0;  //!< in the file, if it is not
    std::map<std::uint32_t, Connection> connections_;
    std::vector<std::uint8_t> packed_, data_;

    bool headerSeen_ = false;
    std::uint64_t indexPosition_ = 0;                     //!< 0: never indexed
    std::uint32_t connectionCount_ = 0, chunkCount_ = 0;  //!< announced
    std::uint32_t indexedConnections_ = 0, indexedChunks_ = 0;
};

const std::string kMagic = "#ROSBAG V2.0\n";
constexpr std::uint64_t kLookAhead = std::uint64_t{64} << 20;
constexpr std::uint32_t kLongestHeader = 1 << 20;
enum Op : std::uint8_t {
    kMessage = 2,
    kBagHeader = 3,
    kIndex = 4,
    kChunk = 5,
    kChunkInfo = 6,
    kConnection = 7
};

/** name=value each, behind their length. */
std::map<std::string, std::string> parseFields(const std::vector<std::uint8_t>& bytes) {
    std::map<std::string, std::string> fields;
    for (std::size_t at = 0; at < bytes.size();) {
        std::uint32_t length = 0;
        if (bytes.size() - at < sizeof(length)) throw Error("is damaged: a record's header");
        std::memcpy(&length, bytes.data() + at, sizeof(length));
        at += sizeof(length);
        if (length > bytes.size() - at)
            throw Error("is damaged: a field is longer than its record's header");
        const std::string field(reinterpret_cast<const char*>(bytes.data()) + at, length);
        const auto equals = field.find('=');
        if (equals == std::string::npos) throw Error("is damaged: a field has no name");
        fields[field.substr(0, equals)] = field.substr(equals + 1);
        at += length;
    }
    return fields;
}

template <typename Number>
Number valueOf(const std::map<std::string, std::string>& fields, const std::string& name) {
    const auto field = fields.find(name);
    Number value = 0;
    if (field == fields.end() || field->second.size() != sizeof(value))
        throw Error("is damaged: a record lacks '" + name + "'");
    std::memcpy(&value, field->second.data(), sizeof(value));
    return value;
}

std::string textOf(const std::map<std::string, std::string>& fields, const std::string& name) {
    const auto field = fields.find(name);
    if (field == fields.end()) throw Error("is damaged: a record lacks '" + name + "'");
    return field->second;
}
Ros1Bag::Ros1Bag(const std::string& path) : MessageSource(path), file_(path) {
    std::string magic(std::min<std::uint64_t>(kMagic.size(), file_.size()), '\0');
    file_.read(magic.data(), magic.size());
    if (magic.size() < kMagic.size()) throw Error("is cut off in its first line");
    if (magic != kMagic) throw Error("is not a ROS 1 bag of version 2.0");
    if (!listByIndex()) listByFirstChunks();
    rewind();
}

void Ros1Bag::rewind() {
    file_.seek(kMagic.size());
    chunk_.clear();
    chunkEnd_ = 0;
    indexedConnections_ = indexedChunks_ = 0;
}

double Ros1Bag::fraction() const {
    return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
}

Ros1Bag::Record Ros1Bag::readRecord(ByteInput& in) {
    const std::uint64_t begin = in.position();
    Record record;
    const auto headerBytes = in.number<std::uint32_t>();
    if (headerBytes > kLongestHeader && headerBytes <= in.left())
        throw Error("is damaged: at byte " + std::to_string(begin) + " a record's header of " +
                    std::to_string(headerBytes) + " bytes");
    in.read(data_, headerBytes);
    record.fields = parseFields(data_);
    record.op = valueOf<std::uint8_t>(record.fields, "op");
    record.bytes = in.number<std::uint32_t>();
    const bool inChunk = &in == &file_ && begin < chunkEnd_;
    if (inChunk && in.position() + record.bytes > chunkEnd_)
        throw Error("is damaged: at byte " + std::to_string(begin) +
                    " a record is longer than its chunk");
    return record;
}

void Ros1Bag::readBagHeader(const Record& record) {
    indexPosition_ = valueOf<std::uint64_t>(record.fields, "index_pos");
    connectionCount_ = valueOf<std::uint32_t>(record.fields, "conn_count");
    chunkCount_ = valueOf<std::uint32_t>(record.fields, "chunk_count");
    headerSeen_ = true;
    file_.skip(record.bytes);
}

void Ros1Bag::readConnection(const Record& record, ByteInput& in) {
    in.read(data_, record.bytes);
    const auto described = parseFields(data_);
    connections_[valueOf<std::uint32_t>(record.fields, "conn")] = {textOf(record.fields, "topic"),
                                                                   textOf(described, "type")};
    if (&in == &file_ && indexPosition_ && file_.position() > indexPosition_) ++indexedConnections_;
}

void Ros1Bag::enterChunk(const Record& record) {
    const std::string compression = textOf(record.fields, "compression");
    const std::uint64_t size = valueOf<std::uint32_t>(record.fields, "size");
    if (compression == "none") {
        // Records are read in place, so the intact part of a cut chunk is used.
        chunkEnd_ = file_.position() + record.bytes;
        return;
    }
    file_.read(packed_, record.bytes);
    // A recorder that was ended fills in the sizes of its last chunk no more.
    if (record.bytes == 0) throw Error("ends in an unfinished compressed chunk");
    unpack(compression, packed_, size, chunk_.bytes());
    chunk_.rewind();
}

std::optional<Message> Ros1Bag::readMessage(const Record& record, ByteInput& in) {
    const auto id = valueOf<std::uint32_t>(record.fields, "conn");
    const auto connection = connections_.find(id);
    if (connection == connections_.end())
        throw Error("is damaged: a message of connection " + std::to_string(id) +
                    ", which has no description");
    const auto& [topic, type] = connection->second;
    if (!isWanted(topic)) {
        in.skip(record.bytes);
        return std::nullopt;
    }
    const auto time = valueOf<std::uint64_t>(record.fields, "time");
    const double log_s =
        static_cast<double>(time & 0xffffffffU) + 1e-9 * static_cast<double>(time >> 32U);
    return Message{topic, type, Encoding::kRos1, log_s, in.view(data_, record.bytes)};
}

std::optional<Message> Ros1Bag::next() {
    while (true) {
        const bool unpacked = chunk_.left() > 0;
        if (!unpacked && file_.left() == 0) break;
        ByteInput& in = unpacked ? static_cast<ByteInput&>(chunk_) : file_;
        const Record record = readRecord(in);
        if (unpacked && record.op != kMessage && record.op != kConnection)
            throw Error("is damaged: a chunk holds a record of kind " + std::to_string(record.op));
        switch (record.op) {
            case kMessage:
                if (auto message = readMessage(record, in)) return message;
                break;
            case kConnection:
                readConnection(record, in);
                break;
            case kChunk:
                enterChunk(record);
                break;
            case kBagHeader:
                readBagHeader(record);
                break;
            case kChunkInfo:
                ++indexedChunks_;
                [[fallthrough]];
            case kIndex:
                in.skip(record.bytes);
                break;
            default:
                throw Error("is damaged: a record of the unknown kind " +
                            std::to_string(record.op));
        }
    }
    checkEnd();
    return std::nullopt;
}

void Ros1Bag::checkEnd() const {
    const bool whole = headerSeen_ && chunkEnd_ <= file_.size() &&
                       (indexPosition_ == 0 ||
                        (indexedConnections_ >= connectionCount_ && indexedChunks_ >= chunkCount_));
    if (!whole) throw Error("is cut off at byte " + std::to_string(file_.size()));
}

bool Ros1Bag::listByIndex() {
    try {
        const Record header = readRecord(file_);
        if (header.op != kBagHeader) return false;
        readBagHeader(header);
        if (indexPosition_ == 0) return false;
        file_.seek(indexPosition_);
        std::map<std::uint32_t, std::size_t> counts;
        while (file_.left() > 0) {
            const Record record = readRecord(file_);
            if (record.op == kConnection) {
                readConnection(record, file_);
            } else if (record.op == kChunkInfo) {
                ++indexedChunks_;
                for (std::uint32_t i = 0; i < record.bytes / 8; ++i) {
                    const auto connection = file_.number<std::uint32_t>();
                    counts[connection] += file_.number<std::uint32_t>();
                }
                file_.skip(record.bytes % 8);
            } else {
                return false;
            }
        }
        checkEnd();
        for (const auto& [id, connection] : connections_)
            addTopic(topics_, {connection.topic, connection.type, counts[id]});
        return true;
    } catch (const Error&) {
        return false;  // next() says so, when it comes there
    }
}

void Ros1Bag::listByFirstChunks() {
    rewind();
    try {
        while (file_.position() < kLookAhead && next()) continue;
    } catch (const Error&) {
        if (connections_.empty()) throw;  // otherwise next() says so, when it comes there
    }
    for (const auto& [id, connection] : connections_)
        addTopic(topics_, {connection.topic, connection.type, std::nullopt});
}
}  // namespace

std::unique_ptr<MessageSource> ros1Source(const std::string& path) {
    return std::make_unique<Ros1Bag>(path);
}
}  // namespace delio::io
