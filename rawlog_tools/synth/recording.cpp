#include "recording.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "cam0_pose.h"
#include "delio/core/error.h"
#include "delio/formats/trajectory.h"
#include "drive.h"

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846;
constexpr double kFastest_m_s = 80;
constexpr double kKnot_m = 1;  // between the places that the path is drawn through

std::string where(const std::string& file, std::size_t pose) {
    return "'" + file + "', pose " + std::to_string(pose);
}

PlanPose seenFromAbove(const Eigen::Isometry3d& lidar, const std::string& where) {
    const auto& R = lidar.linear();
    if (std::hypot(R(0, 0), R(1, 0)) < 0.7)
        throw Error(where + ": the vehicle points up or down; poses have to be KITTI's, of cam0");
    return {0, lidar.translation().x(), lidar.translation().y(), std::atan2(R(1, 0), R(0, 0))};
}

/** Refuses what no vehicle drives. */
void check(const std::vector<PlanPose>& plan, const std::string& file) {
    double ahead = 0, travelled = 0;
    for (std::size_t i = 1; i < plan.size(); ++i) {
        const PlanPose &a = plan[i - 1], &b = plan[i];
        const double step = std::hypot(b.x - a.x, b.y - a.y);
        if (step > kFastest_m_s * kScanPeriod_s)
            throw Error(where(file, i) + ": " + std::to_string(std::lround(step)) +
                        " m from the pose before it, which is 0.1 s earlier; no vehicle is that "
                        "fast");
        if (std::abs(b.yaw - a.yaw) > 0.35)
            throw Error(where(file, i) + ": turned by " +
                        std::to_string(std::lround(std::abs(b.yaw - a.yaw) * 180 / kPi)) +
                        " deg within 0.1 s; no vehicle turns that fast");
        travelled += step;
        ahead += (b.x - a.x) * std::cos(a.yaw) + (b.y - a.y) * std::sin(a.yaw);
    }
    if (travelled > 5 && ahead < 0.8 * travelled)
        throw Error("'" + file +
                    "': the vehicle moves sideways or backwards; poses have to be "
                    "KITTI's, of cam0 (x right, y down, z forward)");
}

std::vector<PlanPose> readPlan(const std::string& file, const Eigen::Isometry3d& lidarToCam0) {
    const auto trajectory = io::readTrajectory(file);
    if (!trajectory.stamps_s.empty())
        throw Error("'" + file + "' has 8 numbers a line; --trajectory takes KITTI poses, 12");
    if (trajectory.poses.size() < 2)
        throw Error("'" + file + "' has one pose; a trajectory has two or more");
    std::vector<PlanPose> plan;
    for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
        plan.push_back(
            seenFromAbove(lidarPoseOf(trajectory.poses[i], lidarToCam0), where(file, i)));
        if (i > 0)
            plan[i].yaw = plan[i - 1].yaw + std::remainder(plan[i].yaw - plan[i - 1].yaw, 2 * kPi);
    }
    check(plan, file);
    return plan;
}

/** By a parabola through seven poses, which leaves steady turns and accelerations as they are. */
std::vector<PlanPose> smoothed(const std::vector<PlanPose>& plan) {
    constexpr std::size_t kHalf = 3;
    constexpr double kWeight[] = {7.0 / 21, 6.0 / 21, 3.0 / 21, -2.0 / 21};
    auto result = plan;
    for (std::size_t i = kHalf; i + kHalf < plan.size(); ++i) {
        PlanPose sum;
        for (std::size_t k = 0; k <= 2 * kHalf; ++k) {
            const PlanPose& p = plan[i + k - kHalf];
            const double weight = kWeight[k > kHalf ? k - kHalf : kHalf - k];
            sum.x += weight * p.x;
            sum.y += weight * p.y;
            sum.yaw += weight * p.yaw;
        }
        result[i] = sum;
    }
    return result;
}

/** Places kKnot_m apart, freed from the sway that would twist the land far beside them. */
std::vector<Station> knotsOf(const std::vector<PlanPose>& plan) {
    std::vector<Station> raw = {{0, plan[0].x, plan[0].y, 0, 0}};
    for (const auto& p : plan)
        if (std::hypot(p.x - raw.back().x, p.y - raw.back().y) >= kKnot_m)
            raw.push_back({0, p.x, p.y, 0, 0});
    // Before the first and behind the last it would go on as seen in a point mirror.
    const auto last = static_cast<int>(raw.size()) - 1;
    const auto place = [&](int i) -> Eigen::Vector2d {
        const auto at = [&](int k) {
            const Station& knot = raw[static_cast<std::size_t>(std::clamp(k, 0, last))];
            return Eigen::Vector2d(knot.x, knot.y);
        };
        if (i < 0) return 2 * at(0) - at(-i);
        if (i > last) return 2 * at(last) - at(2 * last - i);
        return at(i);
    };
    auto knots = raw;
    constexpr double kWeight[] = {0.28, 0.22, 0.11, 0.03};
    for (int i = 0; i <= last; ++i) {
        Eigen::Vector2d sum = kWeight[0] * place(i);
        for (int k = 1; k <= 3; ++k) sum += kWeight[k] * (place(i - k) + place(i + k));
        knots[static_cast<std::size_t>(i)].x = sum.x();
        knots[static_cast<std::size_t>(i)].y = sum.y();
    }
    return knots;
}

/** Fills in s, yaw and curvature from the places. */
void measure(std::vector<Station>& line) {
    for (std::size_t i = 1; i < line.size(); ++i)
        line[i].s =
            line[i - 1].s + std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
    for (std::size_t i = 0; i < line.size(); ++i) {
        const Station &a = line[i > 0 ? i - 1 : 0], &b = line[std::min(i + 1, line.size() - 1)];
        const double yaw = std::atan2(b.y - a.y, b.x - a.x);
        line[i].yaw =
            i == 0 ? yaw : line[i - 1].yaw + std::remainder(yaw - line[i - 1].yaw, 2 * kPi);
    }
    for (std::size_t i = 1; i + 1 < line.size(); ++i)
        line[i].curvature = (line[i + 1].yaw - line[i - 1].yaw) / (line[i + 1].s - line[i - 1].s);
}

/** A smooth curve through the knots, with a straight margin at both ends. */
Path pathThrough(const std::vector<PlanPose>& plan) {
    auto knots = knotsOf(plan);
    // A road user that hardly moves is still on the road.
    const double yaw = plan.front().yaw;
    if (knots.size() < 4)
        knots = {{0, plan[0].x, plan[0].y, 0, 0},
                 {0, plan[0].x + 4 * std::cos(yaw), plan[0].y + 4 * std::sin(yaw), 0, 0}};
    measure(knots);
    std::vector<Station> line;
    const auto addMargin = [&](const Station& end, double from, double to) {
        for (double d = from; d <= to; d += 0.5)
            line.push_back({0, end.x + d * std::cos(end.yaw), end.y + d * std::sin(end.yaw), 0, 0});
    };
    addMargin(knots.front(), -kPathMargin_m, -0.25);
    const double begin = kPathMargin_m;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const Station &a = knots[i], &b = knots[i + 1];
        const double length = b.s - a.s;
        for (double u = 0; u < 1; u += 0.125) {  // Hermite's cubic
            const double w = u * u * (3 - 2 * u), p = u * (1 - u) * (1 - u), q = u * u * (u - 1);
            line.push_back(
                {0, (1 - w) * a.x + w * b.x + length * (p * std::cos(a.yaw) + q * std::cos(b.yaw)),
                 (1 - w) * a.y + w * b.y + length * (p * std::sin(a.yaw) + q * std::sin(b.yaw)), 0,
                 0});
        }
    }
    addMargin(knots.back(), 0, 2 * kPathMargin_m);
    measure(line);
    for (auto& at : line) at.s -= begin;
    return Path(line);
}
}  // namespace

Recording::Recording(const std::string& file, const Eigen::Isometry3d& lidarToCam0)
    : plan_(smoothed(readPlan(file, lidarToCam0))), path_(pathThrough(plan_)) {
    placeOnPath();
}

void Recording::placeOnPath() {
    double s = 0;
    for (auto& plan : plan_) {
        // A few steps forward to where the path is beside the pose; never back.
        for (int i = 0; i < 4; ++i) {
            const Station at = path_.at(s);
            const double ahead =
                (plan.x - at.x) * std::cos(at.yaw) + (plan.y - at.y) * std::sin(at.yaw);
            s += std::max(0.0, ahead);
        }
        plan.s = s;
    }
}

double Recording::duration_s() const {
    return kScanPeriod_s * static_cast<double>(plan_.size() - 1);
}

PlanPose Recording::at(double time_s) const {
    const double scan = time_s / kScanPeriod_s;
    const auto last = static_cast<double>(plan_.size() - 2);
    const auto i = static_cast<std::size_t>(std::clamp(std::floor(scan), 0.0, last));
    const double u = scan - static_cast<double>(i);
    const PlanPose &a = plan_[i], &b = plan_[i + 1];
    if (u < 0 || u > 1)  // straight on, as fast as before
        return {a.s + u * (b.s - a.s), a.x + u * (b.x - a.x), a.y + u * (b.y - a.y),
                a.yaw + u * (b.yaw - a.yaw)};
    // Hermite's cubic: velocities have no jumps, either.
    const PlanPose& before = plan_[i > 0 ? i - 1 : i];
    const PlanPose& after = plan_[std::min(i + 2, plan_.size() - 1)];
    const double spanA = i > 0 ? 2 : 1, spanB = i + 2 < plan_.size() ? 2 : 1;
    const auto between = [&](double PlanPose::*v) {
        const double w = u * u * (3 - 2 * u), p = u * (1 - u) * (1 - u), q = u * u * (u - 1);
        return (1 - w) * a.*v + w * b.*v + p * (b.*v - before.*v) / spanA +
               q * (after.*v - a.*v) / spanB;
    };
    return {a.s + u * (b.s - a.s), between(&PlanPose::x), between(&PlanPose::y),
            between(&PlanPose::yaw)};
}
}  // namespace delio::synth
