#include "bag_topics.h"

#include <algorithm>

#include "../packets/ouster_json.h"
#include "../side_file.h"
#include "delio/core/error.h"
#include "scan_maker.h"
#include "wire_reader.h"

namespace delio::io {
namespace {
std::string listed(const std::vector<Topic>& topics) {
    std::string text;
    for (const Topic& topic : topics)
        text += (text.empty() ? "" : ", ") + topic.name + " (" + topic.type + ")";
    return text;
}

bool endsIn(const std::string& text, const std::string& end) {
    return text.size() >= end.size() &&
           text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/** What the bag says of the sensor of `topic`; empty: it does not. */
std::string recordedDescription(const std::string& topic, const OpenSource& open) {
    const auto bag = open();
    const Topic* found = nullptr;
    for (const Topic& other : bag->topics()) {
        const bool says = endsIn(other.name, "metadata") &&
                          (other.type == "std_msgs/String" || other.type == "std_msgs/msg/String");
        if (says && (!found || inCommon(other.name, topic) > inCommon(found->name, topic)))
            found = &other;
    }
    if (!found) return "";
    bag->only(std::string(found->name));
    try {
        const auto message = bag->next();
        return message ? WireReader(*message).text() : "";
    } catch (const Error&) {
        return "";  // cut off before it came
    }
}
}  // namespace

Topic chooseTopic(const std::vector<Topic>& topics, const std::string& asked) {
    if (topics.empty()) throw Error("holds no messages");
    std::vector<Topic> scans;
    for (const Topic& topic : topics)
        if (scanTypeOf(topic) != ScanType::kNone) scans.push_back(topic);
    if (scans.empty()) throw Error("holds no topic with scans, but " + listed(topics));
    if (asked.empty() && scans.size() > 1)
        throw Error("holds scans of several topics: choose one with --sensor-label: " +
                    listed(scans));
    if (asked.empty()) return scans.front();
    const auto found = std::find_if(scans.begin(), scans.end(),
                                    [&](const Topic& topic) { return topic.name == asked; });
    if (found != scans.end()) return *found;
    std::vector<Topic> ending;  // in what was asked for, as a whole name: /lidar/points in points
    for (const Topic& topic : scans)
        if (endsIn(topic.name, "/" + asked)) ending.push_back(topic);
    if (ending.size() > 1)
        throw Error("holds scans of several topics '" + asked + "': choose one of " +
                    listed(ending));
    if (ending.empty())
        throw Error("holds no scans of the topic '" + asked + "', but of " + listed(scans));
    return ending.front();
}

SideFile ousterDescription(const ScanSource& source, const std::string& topic,
                           const OpenSource& open) {
    if (!source.sensorFile.empty()) {
        SideFile file = sideFile(source.sensorFile);
        if (file.text.empty())
            throw Error("needs the sensor's description, but '" + source.sensorFile +
                        "' is missing or empty");
        return file;
    }
    if (std::string text = recordedDescription(topic, open); !text.empty())
        return {source.path + ", topic metadata", text};
    return ousterJsonBeside(source.path, nullptr, 0);
}
}  // namespace delio::io
