#include "block_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "random.h"

namespace delio::synth {
namespace {
using Eigen::Vector2d;
constexpr double kPi = 3.14159265358979323846;
constexpr double kDense_m = 0.05;

/** A crossing. */
enum Corner { kStart, kEnd, kLeftEnd, kLeftStart, kRightStart, kRightEnd };
using Corners = std::array<Vector2d, 6>;

/** The shared street runs along +x from kStart to kEnd. */
Corners drawCorners(std::uint64_t seed) {
    Random random{seed, 0xB70C};
    const auto about = [&](double x, double y) {
        return Vector2d(x + random.uniform(-3, 3), y + random.uniform(-3, 3));
    };
    // Round one block are some 250 m: traffic needs so much to keep out of its own way.
    const double begin = -random.uniform(18, 26), length = random.uniform(72, 80);
    const double left = random.uniform(59, 66), right = random.uniform(59, 66);
    Corners corners;
    corners[kStart] = {begin, 0};
    corners[kEnd] = {begin + length, 0};
    corners[kLeftEnd] = about(begin + length, left);
    corners[kLeftStart] = about(begin, left);
    corners[kRightStart] = about(begin, -right);
    corners[kRightEnd] = about(begin + length, -right);
    return corners;
}

double yawOf(const Vector2d& direction) { return std::atan2(direction.y(), direction.x()); }

/** The centre line that the vehicle follows, corner after corner. */
class Tracer {
 public:
    explicit Tracer(const Vector2d& begin) { line_.push_back({0, begin.x(), begin.y(), 0, 0}); }

    /** Straight on to `place`. */
    void goTo(const Vector2d& place) {
        const Station from = line_.back();
        const Vector2d begin(from.x, from.y), way = place - begin;
        const int steps = std::max(1, static_cast<int>(way.norm() / kDense_m));
        for (int i = 1; i <= steps; ++i) {
            const Vector2d at = begin + way * i / steps;
            line_.push_back({0, at.x(), at.y(), from.yaw, 0});
        }
    }
    /** To the street from `corner` to `next`, rounding the corner. */
    void turn(const Vector2d& corner, const Vector2d& next) {
        const double yaw = line_.back().yaw;
        const double angle = std::remainder(yawOf(next - corner) - yaw, 2 * kPi);
        if (std::abs(angle) < 1e-3) return;
        const bool sharp = std::abs(angle) > 0.5;
        std::vector<CurvaturePiece> pieces;
        appendTurn(pieces, angle, sharp ? 10.0 : 70.0, sharp ? 6.0 : 4.0);
        // From its first point along +x; then moved to where both tangents meet in the corner.
        double length = 0;
        for (const auto& piece : pieces) length += piece.length;
        const Path bend(0, pieces);
        const Station last = bend.at(length);
        const double tangent = last.x - last.y / std::tan(angle);
        const Eigen::Rotation2Dd turned(yaw);
        const Vector2d begin = corner - turned * Vector2d(tangent, 0);
        goTo(begin);
        const int steps = static_cast<int>(length / kDense_m);
        for (int i = 1; i < steps; ++i) {
            const Station at = bend.at(length * i / steps);
            const Vector2d place = begin + turned * Vector2d(at.x, at.y);
            line_.push_back({0, place.x(), place.y(), yaw + at.yaw, at.curvature});
        }
        const Vector2d end = corner + tangent * (next - corner).normalized();
        line_.push_back({0, end.x(), end.y(), yaw + angle, 0});
    }
    const std::vector<Station>& line() const { return line_; }

 private:
    std::vector<Station> line_;
};

/** `line`, moved sideways; s = 0 at the place `originIndex`. */
std::vector<Station> besideLine(std::vector<Station> line, double side_m, std::size_t originIndex) {
    for (auto& at : line) {
        at.x -= side_m * std::sin(at.yaw);
        at.y += side_m * std::cos(at.yaw);
        at.curvature /= 1 - side_m * at.curvature;
    }
    for (std::size_t i = 1; i < line.size(); ++i)
        line[i].s =
            line[i - 1].s + std::hypot(line[i].x - line[i - 1].x, line[i].y - line[i - 1].y);
    const double origin = line[originIndex].s;
    for (auto& at : line) at.s -= origin;
    return line;
}
}  // namespace

Path blockPath(std::uint64_t seed, double length_m, double side_m) {
    constexpr Corner kRound[] = {kEnd,     kLeftEnd,   kLeftStart,  kStart,      kEnd,
                                 kLeftEnd, kLeftStart, kStart,      kRightStart, kRightEnd,
                                 kEnd,     kStart,     kRightStart, kRightEnd,   kEnd,
                                 kLeftEnd, kLeftStart, kStart};
    const Corners corners = drawCorners(seed);
    Tracer tracer({-kPathMargin_m, 0});
    tracer.goTo({0, 0});
    const std::size_t origin = tracer.line().size() - 1;
    constexpr std::size_t kStops = sizeof(kRound) / sizeof(kRound[0]);
    double travelled = 0;
    do {
        for (std::size_t i = 0; i < kStops; ++i) {
            const auto& next = corners[kRound[(i + 1) % kStops]];
            travelled += (next - corners[kRound[i]]).norm() - 10;  // corners are cut
            tracer.turn(corners[kRound[i]], next);
        }
    } while (travelled < length_m);
    tracer.goTo({corners[kEnd].x() + 2 * kPathMargin_m, 0});
    return Path(besideLine(tracer.line(), side_m, origin));
}
}  // namespace delio::synth
