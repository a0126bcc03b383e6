#include <algorithm>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "delio/core/error.h"
#include "delio/recordings/scan_reader.h"
#include "files/input_file.h"
#include "gnss.h"
#include "imu_samples.h"
#include "message_source.h"
#include "odometry_samples.h"
#include "ouster.h"
#include "packet_messages.h"
#include "scan_maker.h"
#include "sources.h"
#include "static_transforms.h"

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

/** Metadata of the sensor of `topic` in the bag; may be empty. */
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
    bag->only({std::string(found->name)});
    try {
        const auto message = bag->next();
        return message ? WireReader(*message).text() : "";
    } catch (const Error&) {
        return "";  // cut off before it came
    }
}
/** Gives the decoder the description of the RoboSense of `topic`, if the bag has one. */
void describeTo(PacketDecoder& decoder, const std::string& topic, const OpenSource& open) {
    const auto bag = open();
    const Topic* found = nullptr;
    for (const Topic& other : bag->topics())
        if (holdsDescription(plainType(other.type)) &&
            (!found || inCommon(other.name, topic) > inCommon(found->name, topic)))
            found = &other;
    if (!found) return;
    const std::string type = plainType(found->type);
    bag->only({std::string(found->name)});
    try {
        if (const auto message = bag->next()) {
            const StampedPacket packet = descriptionIn(*message, type);
            decoder.add(packet.bytes.data, packet.bytes.size, packet.stamp_s);
        }
    } catch (const Error&) {
        // Damaged, or cut off before it came: its lack is an error where it is needed.
    }
}

/** The requested topic, or the only one with scans. Throws an Error that lists the topics (without
 *  the file's name) if there is no such topic, there are several, or it has no scans. */
Topic chooseTopic(const std::vector<Topic>& topics, const std::string& asked) {
    if (topics.empty()) throw Error("contains no messages");
    std::vector<Topic> scans;
    for (const Topic& topic : topics)
        if (scanTypeOf(topic) != ScanType::kNone) scans.push_back(topic);
    if (scans.empty()) throw Error("contains no topic with LiDAR scans, only " + listed(topics));
    if (asked.empty() && scans.size() > 1)
        throw Error(
            "contains several topics with scans; choose one with --sensor-label, or merge them "
            "with "
            "--sensor-label all: " +
            listed(scans));
    if (asked.empty()) return scans.front();
    const auto found = std::find_if(scans.begin(), scans.end(),
                                    [&](const Topic& topic) { return topic.name == asked; });
    if (found != scans.end()) return *found;
    std::vector<Topic> ending;  // `points` matches /lidar/points, as a whole name
    for (const Topic& topic : scans)
        if (endsIn(topic.name, "/" + asked)) ending.push_back(topic);
    if (ending.size() > 1)
        throw Error("contains several topics that match '" + asked + "'; choose one of " +
                    listed(ending));
    if (ending.empty())
        throw Error("contains no scans of the topic '" + asked + "', only of " + listed(scans));
    return ending.front();
}

/** "topic:frame" in its parts. Names of topics have no colon. */
std::pair<std::string, std::string> topicAndFrame(const std::string& label) {
    const auto colon = label.find(':');
    if (colon == std::string::npos) return {label, ""};
    return {label.substr(0, colon), label.substr(colon + 1)};
}

/** The json of the Ouster whose packets are in `topic`: the file `source.sensorFile`, the bag's
 *  topic .../metadata with the longest common prefix, or the .json next to the bag. Throws Error if
 *  none exists. */
SideFile ousterDescription(const ScanSource& source, const std::string& topic,
                           const OpenSource& open) {
    if (!source.sensorFile.empty()) {
        SideFile file = sideFile(source.sensorFile);
        if (file.text.empty())
            throw Error("needs the sensor's metadata, but '" + source.sensorFile +
                        "' is missing or empty");
        return file;
    }
    if (std::string text = recordedDescription(topic, open); !text.empty())
        return {source.path + ", topic metadata", text};
    return ousterJsonBeside(source.path, nullptr, 0);
}

/** frame_id of a message that begins with a std_msgs/Header; empty where it cannot be decoded. */
std::string frameOf(const Message& message) {
    try {
        return WireReader(message).header().frame;
    } catch (const Error&) {
        return "";
    }
}

/** The topic of the IMU or odometry that belongs to the LiDAR of `topic`: with the longest common
 *  prefix. Empty without one. */
std::string sampleTopicFor(const std::vector<Topic>& topics, const std::string& topic,
                           bool (*isWanted)(const Topic&)) {
    const Topic* found = nullptr;
    for (const Topic& other : topics)
        if (isWanted(other) &&
            (!found || inCommon(other.name, topic) > inCommon(found->name, topic)))
            found = &other;
    return found ? found->name : "";
}

/** The scans of one topic of a bag, whatever it is stored in. */
class BagReader : public ScanReader {
 public:
    BagReader(std::string container, const ScanSource& source, const OpenSource& open)
        : container_(std::move(container)), open_(open), bag_(open()) {
        const auto [label, frame] = topicAndFrame(source.label);
        topic_ = chooseTopic(bag_->topics(), label);
        type_ = scanTypeOf(topic_);
        picksFrame_ = !frame.empty();
        imuTopic_ = sampleTopicFor(bag_->topics(), topic_.name, isImu);
        odometryTopic_ = sampleTopicFor(bag_->topics(), topic_.name, isOdometry);
        std::vector<std::string> wanted{topic_.name};
        for (const auto& name : {imuTopic_, odometryTopic_})
            if (!name.empty()) wanted.push_back(name);
        bag_->only(wanted);
        if (type_ == ScanType::kCloud) {
            maker_ = makeCloudMaker(topic_.name, frame);
            lookAhead(open);
        } else if (type_ == ScanType::kLivox) {
            maker_ = makeLivoxMaker();
        } else if (type_ == ScanType::kPackets) {
            auto decoder = recognisingDecoder(source.sensorFile);
            describeTo(*decoder, topic_.name, open);
            maker_ = makePacketMaker(type_, std::move(decoder));
        } else if (type_ == ScanType::kVelodyne) {
            maker_ = makePacketMaker(type_, velodyneDecoder(source.sensorFile));
        } else {
            const SideFile json = ousterDescription(source, topic_.name, open);
            maker_ = makePacketMaker(type_, ousterDecoder(json.text, json.name));
        }
        describe();
    }

    std::optional<Scan> next() override {
        return guarded([this] {
            std::optional<Scan> scan = nextScan();
            if (scan) scan->index = count_++;
            return scan;
        });
    }

    bool skip() override {
        return guarded([this]() -> std::optional<bool> {
                   // Where a turn ends is known from its packets only, the frame from the message.
                   const bool isAScan =
                       type_ == ScanType::kCloud && !picksFrame_ && maker_->turns();
                   const bool there = isAScan ? nextMessage().has_value() : nextScan().has_value();
                   if (!there) return std::nullopt;
                   ++count_;
                   return true;
               })
            .has_value();
    }

    std::vector<ImuSample> takeImu() override {
        if (!imu_.empty())
            for (ImuSample& sample : imu_) sample.sensorPose = transforms().pose(imuFrame_, frame_);
        return std::exchange(imu_, {});
    }
    std::vector<OdometrySample> takeOdometry() override {
        if (!odometry_.empty())
            for (OdometrySample& sample : odometry_)
                sample.sensorPose = transforms().pose(odometryFrame_, frame_);
        return std::exchange(odometry_, {});
    }
    /** From a second pass over the bag, once. */
    earth::Fixes takeFixes() override {
        if (std::exchange(fixesAreTaken_, true)) return {};
        return fixesOfBag(
            open_, [this](const std::string& frame) { return transforms().pose(frame, frame_); });
    }

    const std::string& label() const override { return topic_.name; }
    const std::set<std::string>& otherLabels() const override { return otherLabels_; }
    std::optional<SensorMount> mount() override {
        SensorMount mount;
        const auto pose = transforms().poseInRoot(frame_, mount.frame);
        mount.pose = pose.value_or(Eigen::Isometry3d::Identity());
        if (!pose || frame_.empty()) mount.frame = topic_.name;  // connected to nothing
        return mount;
    }
    std::optional<double> fraction() const override { return ended_ ? 1 : bag_->fraction(); }
    const std::optional<DriveMeta>& meta() const override { return meta_; }

    Recording recording() const override {
        Recording recording;
        recording.kind = container_ + ", topic " + topic_.name;
        recording.sensor = maker_->sensor();
        recording.findings = maker_->findings();
        recording.imu = imuTopic_;
        recording.odometry = odometryTopic_;
        const bool isCloud = type_ == ScanType::kCloud;
        if (isCloud && maker_->turns())
            recording.scans = topic_.messages;
        else
            recording.motionCompensated = false;
        recording.compensationAssumed = isCloud && !maker_->turns();
        return recording;
    }

 private:
    /** Called for the first messages. A fault is reported when its scan is read. */
    void lookAhead(const OpenSource& open) {
        constexpr std::size_t kMessages = 8;  // some may be empty
        try {
            const auto bag = open();
            bag->only({topic_.name});
            for (std::size_t i = 0; i < kMessages; ++i) {
                const auto message = bag->next();
                if (!message || !maker_->look(*message)) return;
            }
        } catch (const std::exception&) {
        }
    }

    const StaticTransforms& transforms() {
        if (!transforms_) transforms_ = transformsOfBag(open_);
        return *transforms_;
    }

    /** A std_msgs/Header comes first in it. */
    bool hasHeader() const { return type_ != ScanType::kOuster; }

    /** The next message with scans; samples of the IMU before it are kept. */
    std::optional<Message> nextMessage() {
        while (true) {
            auto message = bag_->next();
            if (!message) return message;
            if (message->topic == topic_.name) {
                if (frame_.empty() && hasHeader()) frame_ = frameOf(*message);
                return message;
            }
            if (message->topic == odometryTopic_) {
                const auto sample = odometryOf(*message, odometryFrame_);
                if (sample) addSample(*sample, odometry_);
            } else if (const auto sample = sampleOf(*message, imuFrame_)) {
                addSample(*sample, imu_);
            }
        }
    }

    std::optional<Scan> nextScan() {
        while (true) {
            if (auto scan = maker_->take()) {
                describe();
                return scan;
            }
            if (finished_) return std::nullopt;
            const auto message = nextMessage();
            if (!message) {
                finish();
            } else {
                decode(*message);
            }
        }
    }

    void decode(const Message& message) {
        try {
            maker_->add(message, count_);
        } catch (const Error& e) {
            const std::string scan = "scan " + std::to_string(count_) + " of '" + bag_->path();
            fail(scan + "' (topic " + topic_.name + "): " + e.what());
        }
    }

    void finish() {
        finished_ = true;
        try {
            maker_->finish();
        } catch (const Error& e) {
            fail("'" + bag_->path() + "' (topic " + topic_.name + "): " + e.what());
        }
    }

    /** After an error, and after nothing, the reader is at its end. */
    template <typename Read>
    auto guarded(const Read& read) -> decltype(read()) {
        if (ended_) return std::nullopt;
        try {
            auto result = read();
            ended_ = !result.has_value();
            return result;
        } catch (const std::exception& e) {
            ended_ = true;
            if (named_) throw Error(plainMessage(e));
            throw Error("'" + bag_->path() + "' " + plainMessage(e) + ", after " +
                        std::to_string(count_) + " scans");
        }
    }

    [[noreturn]] void fail(const std::string& what) {
        named_ = true;
        throw Error(what);
    }

    void describe() {
        if (type_ == ScanType::kCloud) return;
        if (!meta_) meta_.emplace();
        meta_->source = "bag";
        meta_->motionCompensated = false;
        // The model without its maker.
        const std::string sensor = maker_->sensor();
        if (!sensor.empty()) meta_->sensorModel = sensor.substr(sensor.find(' ') + 1);
    }

    std::string container_;
    OpenSource open_;
    std::unique_ptr<MessageSource> bag_;
    Topic topic_;
    ScanType type_ = ScanType::kNone;
    std::string imuTopic_;  //!< empty: the bag has no IMU
    std::vector<ImuSample> imu_;
    std::string odometryTopic_;  //!< empty: the bag has no odometry
    std::vector<OdometrySample> odometry_;
    /** Of the LiDAR, the IMU and the odometry; empty: not known. */
    std::string frame_, imuFrame_, odometryFrame_;
    std::optional<StaticTransforms> transforms_;  //!< once they are asked for
    bool fixesAreTaken_ = false;
    bool picksFrame_ = false;  //!< only messages of one frame_id are taken
    std::unique_ptr<ScanMaker> maker_;
    std::optional<DriveMeta> meta_;
    std::set<std::string> otherLabels_;
    std::size_t count_ = 0;
    bool finished_ = false, ended_ = false, named_ = false;
};

std::unique_ptr<ScanReader> openBag(
    const std::string& container, const ScanSource& source,
    std::unique_ptr<MessageSource> (*openPath)(const std::string&)) {
    const OpenSource open = [path = source.path, openPath] { return openPath(path); };
    try {
        return std::make_unique<BagReader>(container, source, open);
    } catch (const std::exception& e) {
        throw Error("'" + source.path + "' " + plainMessage(e));
    }
}

std::unique_ptr<MessageSource> messagesOf(const std::string& path) {
    namespace fs = std::filesystem;
    if (fs::exists(fs::path(path) / "metadata.yaml")) return ros2FolderSource(path);
    if (!fs::is_regular_file(path)) return nullptr;
    switch (kindOf(path)) {
        case FileKind::kRos1Bag:
            return ros1Source(path);
        case FileKind::kRos2Database:
            return ros2DatabaseSource(path);
        case FileKind::kMcap:
            return mcapSource(path);
        default:
            return nullptr;
    }
}
}  // namespace

std::vector<std::string> scanTopicsOf(const std::string& path) {
    std::vector<std::string> names;
    try {
        const auto bag = messagesOf(path);
        if (!bag) return names;
        for (const Topic& topic : bag->topics())
            if (scanTypeOf(topic) != ScanType::kNone) names.push_back(topic.name);
    } catch (const std::exception&) {
        return {};  // opening it says why
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::unique_ptr<ScanReader> openRos1Bag(const ScanSource& source) {
    return openBag("ROS 1 bag", source, ros1Source);
}

std::unique_ptr<ScanReader> openRos2Database(const ScanSource& source) {
    return openBag("ROS 2 bag", source, ros2DatabaseSource);
}

std::unique_ptr<ScanReader> openMcap(const ScanSource& source) {
    return openBag("MCAP", source, mcapSource);
}

std::unique_ptr<ScanReader> openRos2Folder(const ScanSource& source) {
    return openBag("ROS 2 bag", source, ros2FolderSource);
}
}  // namespace delio::io
