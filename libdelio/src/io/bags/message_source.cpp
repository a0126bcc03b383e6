#include "message_source.h"

#include <algorithm>

namespace delio::io {
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
