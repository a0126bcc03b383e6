#include "country_paths.h"

#include <algorithm>
#include <cmath>

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kDegree = 3.14159265358979323846 / 180;

double lengthOf(const std::vector<CurvaturePiece>& pieces) {
    double length = 0;
    for (const auto& piece : pieces) length += piece.length;
    return length;
}
}  // namespace

Path ruralPath(std::uint64_t seed, double length_m) {
    Random random{seed, 0x20A};
    double heading = 0;
    std::vector<CurvaturePiece> pieces = {{kPathMargin_m + random.uniform(30, 60), 0}};
    while (lengthOf(pieces) < length_m + 3 * kPathMargin_m) {
        const bool tight = random.chance(0.25);
        const double radius = tight ? random.uniform(24, 50) : random.uniform(70, 300);
        const double bend = random.uniform(15, tight ? 75 : 45) * kDegree;
        // Turned away from +x as far as that, it turns back.
        const bool left = std::abs(heading) > 40 * kDegree ? heading < 0 : random.chance(0.5);
        const double angle = left ? bend : -bend;
        appendTurn(pieces, angle, radius, std::min(radius * bend, random.uniform(12, 30)));
        heading += angle;
        pieces.push_back({random.uniform(20, 130), 0});
    }
    pieces.push_back({kPathMargin_m, 0});
    return Path(-kPathMargin_m, pieces);
}

Path highwayPath(std::uint64_t seed, double length_m) {
    Random random{seed, 0x416};
    double heading = 0;
    std::vector<CurvaturePiece> pieces = {{kPathMargin_m + random.uniform(50, 200), 0}};
    while (lengthOf(pieces) < length_m + 3 * kPathMargin_m) {
        const double radius = random.uniform(700, 2000), bend = random.uniform(6, 22) * kDegree;
        const bool left = std::abs(heading) > 25 * kDegree ? heading < 0 : random.chance(0.5);
        const double angle = left ? bend : -bend;
        appendTurn(pieces, angle, radius, std::min(radius * bend, 110.0));
        heading += angle;
        pieces.push_back({random.uniform(20, 400), 0});
    }
    pieces.push_back({kPathMargin_m, 0});
    return Path(-kPathMargin_m, pieces);
}

Path forestPath(std::uint64_t seed, double length_m) {
    Random random{seed, 0xF03};
    double heading = 0;
    std::vector<CurvaturePiece> pieces = {{kPathMargin_m + random.uniform(4, 12), 0}};
    while (lengthOf(pieces) < length_m + 3 * kPathMargin_m) {
        const double radius = random.uniform(8, 22), bend = random.uniform(20, 65) * kDegree;
        const bool left = std::abs(heading) > 35 * kDegree ? heading < 0 : random.chance(0.5);
        const double angle = left ? bend : -bend;
        appendTurn(pieces, angle, radius, std::min(radius * bend, random.uniform(3, 6)));
        heading += angle;
        pieces.push_back({random.uniform(1, 10), 0});
    }
    pieces.push_back({kPathMargin_m, 0});
    return Path(-kPathMargin_m, pieces);
}

Path straightPath(double length_m) {
    return Path(-kPathMargin_m, {{length_m + 4 * kPathMargin_m, 0}});
}
}  // namespace delio::synth
