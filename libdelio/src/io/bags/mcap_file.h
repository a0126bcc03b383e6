#pragma once
#include <cstdint>
#include <map>

#include "byte_input.h"
#include "message_source.h"

namespace delio::io {
/** Reads an MCAP file record by record from its begin; its summary is used for topics() only.
 *  Chunks may be compressed with lz4 or zstd; their checksums are held where they have any. */
class McapFile : public MessageSource {
 public:
    /** Throws Error if it cannot be opened or is no MCAP file. */
    explicit McapFile(const std::string& path);

    const std::vector<Topic>& topics() const override { return topics_; }
    void only(const std::string& topic) override { only_ = topic; }
    std::optional<Message> next() override;
    double fraction() const override;
    const std::string& path() const override { return path_; }

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

    std::string path_;
    FileInput file_;
    MemoryInput chunk_;
    std::map<std::uint16_t, std::string> schemas_;
    std::map<std::uint16_t, Channel> channels_;
    std::vector<Topic> topics_;
    std::optional<std::string> only_;
    std::vector<std::uint8_t> packed_, data_;
    bool dataEnded_ = false, chunkIsCut_ = false, counted_ = false;
};
}  // namespace delio::io
