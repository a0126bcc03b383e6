#include "message_source.h"

#include <algorithm>

#include "delio/core/error.h"

namespace delio::io {
namespace {
[[noreturn]] void tooShort(std::size_t size) {
    throw Error("the message of " + std::to_string(size) + " bytes is cut off or has another type");
}
}  // namespace

WireReader::WireReader(const Bytes& message, Encoding encoding)
    : data_(message.data), size_(message.size), ros1_(encoding == Encoding::kRos1) {
    if (encoding == Encoding::kOther)
        throw Error("the message is neither in ROS 1 nor CDR encoding");
    if (ros1_) return;
    if (size_ < 4) tooShort(size_);
    // Plain CDR: 0 is big-endian, 1 little-endian; the rest of the header says nothing.
    if (data_[0] != 0 || data_[1] > 1) throw Error("the message has an unknown CDR encoding");
    bigEndian_ = data_[1] == 0;
    data_ += 4;
    size_ -= 4;
}

Bytes WireReader::bytes(std::size_t count) {
    if (at_ > size_ || count > size_ - at_) tooShort(size_);
    const Bytes result{data_ + at_, count};
    at_ += count;
    return result;
}

std::string WireReader::text() {
    const Bytes raw = byteArray();
    std::string text(reinterpret_cast<const char*>(raw.data), raw.size);
    // CDR counts a 0 at the end.
    if (!ros1_ && !text.empty() && text.back() == '\0') text.pop_back();
    return text;
}

std::size_t WireReader::length(std::size_t least) {
    const std::size_t count = number<std::uint32_t>();
    if (at_ > size_ || count > (size_ - at_) / least) tooShort(size_);
    return count;
}

double WireReader::time() {
    const double seconds = number<std::uint32_t>();
    return seconds + 1e-9 * number<std::uint32_t>();
}

WireReader::Header WireReader::header() {
    if (ros1_) number<std::uint32_t>();  // seq
    Header header;
    header.stamp_s = time();
    header.frame = text();
    return header;
}

Encoding encodingOf(const std::string& name) {
    if (name == "ros1") return Encoding::kRos1;
    return name == "cdr" ? Encoding::kCdr : Encoding::kOther;
}

void addTopic(std::vector<Topic>& topics, const Topic& topic) {
    const auto same = std::find_if(topics.begin(), topics.end(),
                                   [&](const Topic& other) { return other.name == topic.name; });
    if (same == topics.end()) {
        topics.push_back(topic);
    } else if (same->messages && topic.messages) {
        *same->messages += *topic.messages;
    } else {
        same->messages.reset();
    }
}
}  // namespace delio::io
