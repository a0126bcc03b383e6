#include "bag_topics.h"

#include <algorithm>
#include <filesystem>

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

/** Empty: the bag does not say. */
std::string recordedDescription(const OpenSource& open) {
    const auto bag = open();
    const auto& topics = bag->topics();
    const auto found = std::find_if(topics.begin(), topics.end(), [](const Topic& topic) {
        return endsIn(topic.name, "metadata") &&
               (topic.type == "std_msgs/String" || topic.type == "std_msgs/msg/String");
    });
    if (found == topics.end()) return "";
    bag->only(found->name);
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

SideFile ousterDescription(const ScanSource& source, const OpenSource& open) {
    if (!source.sensorFile.empty()) {
        SideFile file = sideFile(source.sensorFile);
        if (file.text.empty())
            throw Error("needs the sensor's description, but '" + source.sensorFile +
                        "' is missing or empty");
        return file;
    }
    if (std::string text = recordedDescription(open); !text.empty())
        return {source.path + ", topic metadata", text};
    std::filesystem::path bag = source.path;
    if (!bag.has_filename()) bag = bag.parent_path();  // DRIVE/
    SideFile beside = sideFile(bag.replace_extension(".json").string());
    if (beside.text.empty())
        throw Error(
            "holds an Ouster's packets but not the sensor's description: give its .json "
            "with --sensor-info, or lay it beside as '" +
            beside.name + "'");
    return beside;
}
}  // namespace delio::io
