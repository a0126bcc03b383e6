#include "static_transforms.h"

#include <cmath>
#include <exception>

namespace delio::io {
namespace {
std::string nameOf(const std::string& frame) {
    return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

Eigen::Isometry3d poseIn(WireReader& reader) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (double& value : pose.translation()) value = reader.real();
    Eigen::Quaterniond rotation;
    for (double& value : rotation.coeffs()) value = reader.real();
    pose.linear() = rotation.normalized().toRotationMatrix();
    return pose;
}

/** Adds those of a tf2_msgs/TFMessage. */
void addMessage(const Message& message, StaticTransforms& transforms) {
    constexpr std::size_t kLeast = 60;  // bytes of a transform
    WireReader reader(message);
    const std::size_t count = reader.length(kLeast);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string parent = reader.header().frame;
        const std::string child = reader.text();
        transforms.add(parent, child, poseIn(reader));
    }
}
}  // namespace

void StaticTransforms::add(const std::string& parent, const std::string& child,
                           const Eigen::Isometry3d& pose) {
    if (pose.matrix().allFinite()) links_[nameOf(child)] = {nameOf(parent), pose};
}

std::optional<Eigen::Isometry3d> StaticTransforms::poseInRoot(std::string frame,
                                                              std::string& root) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    frame = nameOf(frame);
    for (std::size_t steps = 0; steps <= links_.size(); ++steps) {
        const auto link = links_.find(frame);
        if (link == links_.end()) {
            root = frame;
            return pose;
        }
        pose = link->second.pose * pose;
        frame = link->second.parent;
    }
    return {};  // a circle
}

std::optional<Eigen::Isometry3d> StaticTransforms::pose(const std::string& frame,
                                                        const std::string& reference) const {
    std::string root, otherRoot;
    const auto own = poseInRoot(frame, root);
    const auto other = poseInRoot(reference, otherRoot);
    if (!own || !other || root != otherRoot) return {};
    return other->inverse() * *own;
}

StaticTransforms transformsOfBag(const OpenSource& open) {
    constexpr const char* kTopic = "/tf_static";
    StaticTransforms transforms;
    try {
        const auto bag = open();
        const auto& topics = bag->topics();
        const auto found = std::find_if(topics.begin(), topics.end(),
                                        [&](const Topic& topic) { return topic.name == kTopic; });
        if (found == topics.end()) return transforms;
        const auto most = found->messages;
        bag->only({kTopic});
        for (std::size_t i = 0; !most || i < *most; ++i) {
            const auto message = bag->next();
            if (!message) break;
            addMessage(*message, transforms);
        }
    } catch (const std::exception&) {
        // The reader of the scans says what is damaged.
    }
    return transforms;
}
}  // namespace delio::io
