#include "delio/movers/outlines.h"

#include <algorithm>
#include <cmath>

namespace delio::movers {
namespace {
constexpr float kMetres = 0.5F, kShare = 0.3F;

inline bool alike(float a, float b) { return std::abs(a - b) < kMetres + kShare * (a < b ? b : a); }
}  // namespace

bool alike(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return alike(a.x(), b.x()) && alike(a.y(), b.y()) && alike(a.z(), b.z());
}

void Outlines::add(const Eigen::Vector3f& place, const Eigen::Vector3f& size) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        places_[axis].push_back(place[static_cast<Eigen::Index>(axis)]);
        sizes_[axis].push_back(size[static_cast<Eigen::Index>(axis)]);
    }
}

std::pair<std::size_t, std::size_t> Outlines::about(float x, float reach) const {
    const auto& xs = places_[0];
    const auto first = std::lower_bound(xs.begin(), xs.end(), x - reach);
    return {first - xs.begin(), std::upper_bound(first, xs.end(), x + reach) - xs.begin()};
}

void Outlines::findAlike(const std::pair<std::size_t, std::size_t>& numbers,
                         const Eigen::Vector3f& size, std::vector<std::int32_t>& found) const {
    found.resize(this->size());
    const float x = size.x(), y = size.y(), z = size.z();
    const float *xs = sizes_[0].data(), *ys = sizes_[1].data(), *zs = sizes_[2].data();
    std::int32_t* const to = found.data();
    // Without branches, in numbers as wide as the sizes: vector instructions.
    for (std::size_t i = numbers.first; i < numbers.second; ++i)
        to[i] = std::int32_t{alike(xs[i], x)} & std::int32_t{alike(ys[i], y)} &
                std::int32_t{alike(zs[i], z)};
}
}  // namespace delio::movers
