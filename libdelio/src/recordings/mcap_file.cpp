#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <map>

#include "byte_input.h"
#include "delio/core/error.h"
#include "message_source.h"

namespace delio::io {
namespace {
/** Reads an MCAP file record by record from its begin; its summary is used for topics() only.
 *  Chunks may be compressed with lz4 or zstd; their checksums are held where they have any. */
class McapFile : public MessageSource {
 public:
    /** Throws Error if it cannot be opened or is no MCAP file. */
    explicit McapFile(const std::string& path);

    std::optional<Message> next() override;
    double fraction() const override;

 private:
    struct Channel {
        std::string topic, type;
        Encoding encoding = Encoding::kOther;
        std::optional<std::size_t> messages;
    };

    void rewind();
    /** One record, all of it; a message if it is one that is wanted. */
    std::optional<Message> readRecord(ByteInput& in);
    std::optional<Message> readMessage(ByteInput& in, std::uint64_t bytes);
    /** A record that holds neither a message nor messages: it is taken or passed over. */
    void readOther(ByteInput& in, std::uint8_t op, std::uint64_t bytes);
    void readSchema(ByteInput& in);
    void readChannel(ByteInput& in);
    void readStatistics(ByteInput& in);
    void enterChunk(std::uint64_t bytes);
    void checkEnd();
    bool listBySummary();
    void listByFirstChunks();
    void takeTopics();

    FileInput file_;
    MemoryInput chunk_;
    std::map<std::uint16_t, std::string> schemas_;
    std::map<std::uint16_t, Channel> channels_;
    std::vector<std::uint8_t> packed_, data_;
    bool dataEnded_ = false, chunkIsCut_ = false, counted_ = false;
};

const std::string kMagic = "\x89MCAP0\r\n";
constexpr std::uint64_t kLookAhead = std::uint64_t{64} << 20;
enum Op : std::uint8_t {
    kFooter = 2,
    kSchema = 3,
    kChannel = 4,
    kMessage = 5,
    kChunk = 6,
    kStatistics = 11,
    kDataEnd = 15
};
constexpr std::uint64_t kRecordStart = 9;  // kind and length
constexpr std::uint64_t kFooterBytes = kRecordStart + 20;
constexpr std::uint64_t kMessageStart = 22;

std::uint32_t checksum(const std::vector<std::uint8_t>& bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}
McapFile::McapFile(const std::string& path) : MessageSource(path), file_(path) {
    std::string magic(std::min<std::uint64_t>(kMagic.size(), file_.size()), '\0');
    file_.read(magic.data(), magic.size());
    if (magic.size() < kMagic.size()) throw Error("is cut off in its first bytes");
    if (magic != kMagic) throw Error("is not an MCAP file of version 0");
    if (!listBySummary()) listByFirstChunks();
    rewind();
}

void McapFile::rewind() {
    file_.seek(kMagic.size());
    chunk_.clear();
    dataEnded_ = chunkIsCut_ = false;
}

double McapFile::fraction() const {
    return static_cast<double>(file_.position()) / static_cast<double>(file_.size());
}

void McapFile::readSchema(ByteInput& in) {
    const auto id = in.number<std::uint16_t>();
    schemas_[id] = in.text();
}

void McapFile::readChannel(ByteInput& in) {
    const auto id = in.number<std::uint16_t>();
    const auto schema = in.number<std::uint16_t>();
    Channel& channel = channels_[id];
    channel.topic = in.text();
    channel.encoding = encodingOf(in.text());
    const auto type = schemas_.find(schema);
    channel.type = type == schemas_.end() ? "" : type->second;
}

void McapFile::readStatistics(ByteInput& in) {
    in.skip(42);  // totals and times
    const std::uint32_t bytes = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < bytes / 10; ++i) {
        const auto channel = channels_.find(in.number<std::uint16_t>());
        const auto messages = in.number<std::uint64_t>();
        if (channel != channels_.end()) channel->second.messages = messages;
    }
    counted_ = true;
}

void McapFile::enterChunk(std::uint64_t bytes) {
    const std::uint64_t begin = file_.position();
    const bool isCut = bytes > file_.left();
    file_.skip(16);  // first and last time
    const auto size = file_.number<std::uint64_t>();
    const auto crc = file_.number<std::uint32_t>();
    const std::string compression = file_.text();
    const auto packedBytes = file_.number<std::uint64_t>();
    const std::uint64_t taken = file_.position() - begin;
    if (taken > bytes || packedBytes > bytes - taken)
        throw Error("is damaged: a chunk is longer than its record");
    if (compression.empty()) {
        if (isCut) {  // read in place, as far as it exists
            chunkIsCut_ = true;
            return;
        }
        if (packedBytes != size) throw Error("is damaged: a chunk has two sizes");
        file_.read(chunk_.bytes(), packedBytes);
    } else {
        file_.read(packed_, packedBytes);
        unpack(compression, packed_, size, chunk_.bytes());
    }
    if (crc != 0 && checksum(chunk_.bytes()) != crc)
        throw Error("is damaged: a chunk has the wrong checksum");
    chunk_.rewind();
    file_.skip(bytes - taken - packedBytes);
}

std::optional<Message> McapFile::readMessage(ByteInput& in, std::uint64_t bytes) {
    if (bytes < kMessageStart) throw Error("is damaged: a message's record is too short");
    const auto id = in.number<std::uint16_t>();
    in.skip(4);  // sequence
    const auto log_ns = in.number<std::uint64_t>();
    in.skip(8);  // publish time
    const auto channel = channels_.find(id);
    if (channel == channels_.end())
        throw Error("is damaged: a message of channel " + std::to_string(id) +
                    ", which has no description");
    const auto& [topic, type, encoding, messages] = channel->second;
    if (!isWanted(topic)) {
        in.skip(bytes - kMessageStart);
        return std::nullopt;
    }
    return Message{topic, type, encoding, 1e-9 * static_cast<double>(log_ns),
                   in.view(data_, bytes - kMessageStart)};
}

std::optional<Message> McapFile::readRecord(ByteInput& in) {
    const auto op = in.number<std::uint8_t>();
    const auto bytes = in.number<std::uint64_t>();
    if (op == kMessage) return readMessage(in, bytes);
    if (op == kChunk) {
        if (&in != &file_) throw Error("is damaged: a chunk in a chunk");
        enterChunk(bytes);
        return std::nullopt;
    }
    readOther(in, op, bytes);
    return std::nullopt;
}

void McapFile::readOther(ByteInput& in, std::uint8_t op, std::uint64_t bytes) {
    const std::uint64_t left = in.left();
    if (bytes <= left) {
        if (op == kSchema) readSchema(in);
        if (op == kChannel) readChannel(in);
        if (op == kStatistics) readStatistics(in);
        if (op == kDataEnd) dataEnded_ = true;
    }
    const std::uint64_t taken = left - in.left();
    if (taken > bytes) throw Error("is damaged: a record is longer than it says");
    in.skip(bytes - taken);
}

std::optional<Message> McapFile::next() {
    while (chunk_.left() > 0 || !dataEnded_) {
        ByteInput& in = chunk_.left() > 0 ? static_cast<ByteInput&>(chunk_) : file_;
        if (auto message = readRecord(in)) return message;
    }
    checkEnd();
    return std::nullopt;
}

void McapFile::checkEnd() {
    const std::uint64_t least = file_.position() + kFooterBytes + kMagic.size();
    std::string end(kMagic.size(), '\0');
    if (least <= file_.size()) {
        file_.seek(file_.size() - end.size());
        file_.read(end.data(), end.size());
    }
    if (chunkIsCut_ || end != kMagic)
        throw Error("is cut off at byte " + std::to_string(file_.size()));
}

bool McapFile::listBySummary() {
    try {
        checkEnd();
        file_.seek(file_.size() - kMagic.size() - kFooterBytes);
        if (file_.number<std::uint8_t>() != kFooter) return false;
        file_.skip(8);
        const auto summary = file_.number<std::uint64_t>();
        if (summary == 0) return false;
        file_.seek(summary);
        const std::uint64_t footer = file_.size() - kMagic.size() - kFooterBytes;
        while (file_.position() < footer) {
            const auto op = file_.number<std::uint8_t>();
            readOther(file_, op, file_.number<std::uint64_t>());
        }
    } catch (const Error&) {
        return false;  // next() says so, when it comes there
    }
    takeTopics();
    return !topics_.empty();
}

void McapFile::listByFirstChunks() {
    rewind();
    try {
        while (file_.position() < kLookAhead && next()) continue;
    } catch (const Error&) {
        takeTopics();
        if (topics_.empty()) throw;  // otherwise next() says so, when it comes there
    }
    takeTopics();
}

void McapFile::takeTopics() {
    topics_.clear();
    for (const auto& [id, channel] : channels_) {
        // Channels without messages are not named.
        const std::size_t unnamed = 0;
        addTopic(topics_,
                 {channel.topic, channel.type,
                  counted_ ? std::optional(channel.messages.value_or(unnamed)) : std::nullopt});
    }
}
}  // namespace

std::unique_ptr<MessageSource> mcapSource(const std::string& path) {
    return std::make_unique<McapFile>(path);
}
}  // namespace delio::io
