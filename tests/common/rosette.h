#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bag_writers.h"

/** A LiDAR whose pattern does not repeat (two prisms that turn, six lines, 70 deg wide), on a
 * smooth path through a hall with pillars. */
namespace delio::test {
/** Pose of the sensor `t` seconds after the begin. */
inline Eigen::Isometry3d rosettePose(double t) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << -9 + t, 0.8 * std::sin(0.5 * t), 0.1 * std::sin(0.9 * t);
    pose.linear() = (Eigen::AngleAxisd(0.3 * std::sin(0.6 * t), Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(0.05 * std::sin(1.1 * t), Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(0.04 * std::sin(0.8 * t), Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    return pose;
}

/** Where the beam of `line` points `t` seconds after the begin, in the sensor's frame. */
inline Eigen::Vector3d rosetteBeam(double t, int line) {
    constexpr double kHalf = 17.5 * M_PI / 180, kApart = 0.004;
    const double first = 2 * M_PI * 121.57 * t, second = -2 * M_PI * 77.73 * t;
    const double across = kHalf * (std::cos(first) + std::cos(second)) + kApart * line;
    const double up = kHalf * (std::sin(first) + std::sin(second));
    return {std::cos(across) * std::cos(up), std::sin(across) * std::cos(up), std::sin(up)};
}

/** Range to the hall's walls or to a pillar. */
inline double rosetteRange(const Eigen::Vector3d& from, const Eigen::Vector3d& beam) {
    using Box = std::array<Eigen::Vector3d, 2>;
    static const std::vector<Box> kPillars = [] {
        std::vector<Box> pillars;
        for (int i = 0; i < 12; ++i) {
            const double x = -6 + 1.9 * i, y = (i % 2 ? 1 : -1) * (2.2 + 0.7 * (i % 3));
            pillars.push_back({Eigen::Vector3d(x, y, -1.5), Eigen::Vector3d(x + 0.6, y + 0.8, 3)});
            pillars.push_back(
                {Eigen::Vector3d(x + 0.4, -y, -1.5), Eigen::Vector3d(x + 1.4, 0.5 - y, -0.6)});
        }
        return pillars;
    }();
    const auto cross = [&](const Box& box, bool inside) {
        double enter = 0, leave = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            const double a = (box[0][k] - from[k]) / beam[k], b = (box[1][k] - from[k]) / beam[k];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        if (inside) return leave;
        return enter < leave && enter > 0 ? enter : std::numeric_limits<double>::infinity();
    };
    double range = cross({Eigen::Vector3d(-12, -6, -1.5), Eigen::Vector3d(18, 6, 3)}, true);
    for (const Box& pillar : kPillars) range = std::min(range, cross(pillar, false));
    return range;
}

struct RosetteDrive {
    double begin_s = 1700000000;
    double seconds = 6;
    double message_s = 0.1;
    std::size_t pointsPerSecond = 240000;
    std::uint64_t clock_ns = 5'000'000'000;  //!< of the sensor, at the begin
    WireWriter::Kind kind = WireWriter::Kind::kRos1;
    bool driver2 = false;
};

/** A CustomMsg with the points from `from_s` to before `to_s`, seconds after the begin. */
inline BagBytes livoxMessage(const RosetteDrive& drive, double from_s, double to_s) {
    const auto bits = [](double value) {
        const auto number = static_cast<float>(value);
        std::uint32_t result = 0;
        std::memcpy(&result, &number, sizeof(result));
        return result;
    };
    const auto count = static_cast<std::uint32_t>(
        std::lround((to_s - from_s) * static_cast<double>(drive.pointsPerSecond)));
    constexpr int kLines = 6;
    WireWriter out(drive.kind);
    out.header(drive.begin_s + from_s, "livox_frame");
    out.number(drive.clock_ns + static_cast<std::uint64_t>(std::llround(1e9 * from_s)));
    out.number(count).number(std::uint8_t{1});
    for (int i = 0; i < 3; ++i) out.number(std::uint8_t{0});
    out.number(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const int line = static_cast<int>(i % kLines);
        const double since_s =
            static_cast<double>(i - i % kLines) / static_cast<double>(drive.pointsPerSecond);
        const Eigen::Isometry3d pose = rosettePose(from_s + since_s);
        const Eigen::Vector3d beam = rosetteBeam(from_s + since_s, line);
        const Eigen::Vector3d point = rosetteRange(pose.translation(), pose.linear() * beam) * beam;
        out.number(static_cast<std::uint32_t>(std::lround(1e9 * since_s)));
        for (int k = 0; k < 3; ++k) out.number(bits(point[k]));
        out.number(static_cast<std::uint8_t>(50 + line)).number(std::uint8_t{0x10});
        out.number(static_cast<std::uint8_t>(line));
    }
    return out.message();
}

inline BagContents rosetteBag(const RosetteDrive& drive) {
    const bool ros1 = drive.kind == WireWriter::Kind::kRos1;
    BagContents bag;
    bag.encoding = ros1 ? "ros1" : "cdr";
    bag.topics = {{"/livox/lidar", std::string("livox_ros_driver") + (drive.driver2 ? "2" : "") +
                                       (ros1 ? "/CustomMsg" : "/msg/CustomMsg")}};
    const auto messages = static_cast<int>(std::lround(drive.seconds / drive.message_s));
    for (int i = 0; i < messages; ++i)
        bag.messages.push_back(
            {0, drive.begin_s + drive.message_s * (i + 1),
             livoxMessage(drive, drive.message_s * i, drive.message_s * (i + 1))});
    return bag;
}
}  // namespace delio::test
