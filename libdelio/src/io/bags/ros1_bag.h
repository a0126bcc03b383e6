#pragma once
#include <cstdint>
#include <map>

#include "byte_input.h"
#include "message_source.h"

namespace delio::io {
/** Reads a ROS 1 bag, version 2.0, record by record from its begin: bags that were cut off or never
 *  indexed (.bag.active) are read as far as they go. Chunks may be compressed with bz2 or lz4. */
class Ros1Bag : public MessageSource {
 public:
    /** Throws Error if it cannot be opened or is no such bag. */
    explicit Ros1Bag(const std::string& path);

    const std::vector<Topic>& topics() const override { return topics_; }
    void only(const std::string& topic) override { only_ = topic; }
    /** Throws Error where the bag is cut off; a bag that was never indexed ends where its last
     *  record does. */
    std::optional<Message> next() override;
    double fraction() const override;
    const std::string& path() const override { return path_; }

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

    std::string path_;
    FileInput file_;
    MemoryInput chunk_;           //!< the chunk that is read, if it is compressed
    std::uint64_t chunkEnd_ = 0;  //!< in the file, if it is not
    std::map<std::uint32_t, Connection> connections_;
    std::vector<Topic> topics_;
    std::optional<std::string> only_;
    std::vector<std::uint8_t> packed_, data_;

    bool headerSeen_ = false;
    std::uint64_t indexPosition_ = 0;                     //!< 0: never indexed
    std::uint32_t connectionCount_ = 0, chunkCount_ = 0;  //!< announced
    std::uint32_t indexedConnections_ = 0, indexedChunks_ = 0;
};
}  // namespace delio::io
