#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace delio::io {
/** Bytes that lie elsewhere. */
struct Bytes {
    const std::uint8_t* data = nullptr;
    std::size_t size = 0;
};

/** How ROS 1 and ROS 2 write a message; kOther: neither. */
enum class Encoding { kRos1, kCdr, kOther };
/** Of "ros1" and "cdr", as MCAP and ROS 2 name them. */
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
    MessageSource() = default;
    virtual ~MessageSource() = default;
    MessageSource(const MessageSource&) = delete;
    MessageSource& operator=(const MessageSource&) = delete;

    /** What there is in the bag; of one without an index, in its first 64 MiB. */
    virtual const std::vector<Topic>& topics() const = 0;

    /** Messages of other topics are passed over from here on; to be called before next(). */
    virtual void only(const std::string& topic) = 0;

    /** The next message, or nothing at the end. Throws Error where the bag is cut off or damaged;
     *  not to be called after that. */
    virtual std::optional<Message> next() = 0;

    /** Part of the bag read so far, 0 to 1. */
    virtual double fraction() const = 0;

    /** The file that is being read. */
    virtual const std::string& path() const = 0;
};

/** Opens a bag, from its begin, as often as it is called. */
using OpenSource = std::function<std::unique_ptr<MessageSource>()>;

/** Adds a topic, or messages to it where it is there already. */
void addTopic(std::vector<Topic>& topics, const Topic& topic);
}  // namespace delio::io
