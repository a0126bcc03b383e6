#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace delio::io {
/** Bytes that lie elsewhere. */
struct Bytes {
    const std::uint8_t* data = nullptr;
    std::size_t size = 0;
};

/** How ROS 1 and ROS 2 write a message; kOther: neither. */
enum class Encoding { kRos1, kCdr, kOther };
/** Parses "ros1" and "cdr", the names in MCAP and ROS 2. */
Encoding encodingOf(const std::string& name);

/** A topic of a bag. */
struct Topic {
    std::string name;
    std::string type;                     //!< e.g. sensor_msgs/msg/PointCloud2
    std::optional<std::size_t> messages;  //!< where they are counted without reading them
};

/** One recorded message. */
struct Message {
    std::string topic, type;
    Encoding encoding = Encoding::kOther;
    double log_s = 0;  //!< Unix seconds at which it was recorded
    Bytes bytes;       //!< until the next message is read
};

/** Gives the messages of a bag one at a time, as they lie in it; memory does not grow with its
 *  length. What it throws, Error, does not name the file. */
class MessageSource {
 public:
    virtual ~MessageSource() = default;
    MessageSource(const MessageSource&) = delete;
    MessageSource& operator=(const MessageSource&) = delete;

    /** Topics of the bag; without an index, those in its first 64 MiB. */
    const std::vector<Topic>& topics() const { return topics_; }

    /** Messages of other topics are passed over from here on; to be called before next(). */
    virtual void only(const std::vector<std::string>& topics) { only_ = topics; }

    /** The next message, or nothing at the end. Throws Error where the bag is cut off or damaged;
     *  not to be called after that. */
    virtual std::optional<Message> next() = 0;

    /** Part of the bag read so far, 0 to 1. */
    virtual double fraction() const = 0;

    /** The file that is being read. */
    const std::string& path() const { return path_; }

 protected:
    explicit MessageSource(std::string path) : path_(std::move(path)) {}

    std::string path_;
    std::vector<Topic> topics_;
    /** The messages of this topic are given. */
    bool isWanted(const std::string& topic) const {
        return only_.empty() || std::find(only_.begin(), only_.end(), topic) != only_.end();
    }

    std::vector<std::string> only_;  //!< empty: all topics
};

/** Opens a bag, from its begin, as often as it is called. */
using OpenSource = std::function<std::unique_ptr<MessageSource>()>;

/** Adds a topic, or messages to it where it is there already. */
void addTopic(std::vector<Topic>& topics, const Topic& topic);

/** A ROS 1 bag, version 2.0. Throws Error where it cannot be opened or is no such bag. */
std::unique_ptr<MessageSource> ros1Source(const std::string& path);
/** An MCAP file. Throws likewise. */
std::unique_ptr<MessageSource> mcapSource(const std::string& path);
/** A ROS 2 bag of sqlite3 (.db3), in the order of its times. Throws likewise, and where it is
 *  compressed. */
std::unique_ptr<MessageSource> ros2DatabaseSource(const std::string& path);
/** The folder of a ROS 2 bag: the .db3 or .mcap files that its metadata.yaml names, one after the
 *  other. Throws Error where metadata.yaml is missing or cannot be understood, names no files, or
 *  says that they are compressed, and as the first file's source. */
std::unique_ptr<MessageSource> ros2FolderSource(const std::string& folder);

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
    /** A floating-point number of 8 bytes. */
    double real() {
        const auto bits = number<std::uint64_t>();
        double value = 0;
        std::memcpy(&value, &bits, sizeof(value));
        return value;
    }
    /** Seconds of a time. */
    double time();
    /** std_msgs/Header. */
    struct Header {
        double stamp_s = 0;
        std::string frame;
    };
    Header header();

 private:
    const std::uint8_t* data_;
    std::size_t size_, at_ = 0;
    bool ros1_, bigEndian_ = false;
};
}  // namespace delio::io
