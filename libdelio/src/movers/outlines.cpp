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
                         const Eigen::Vector3f& size, std::vector<std::size_t>& found) const {
    const float x = size.x(), y = size.y(), z = size.z();
    const float *xs = sizes_[0].data(), *ys = sizes_[1].data(), *zs = sizes_[2].data();
    // Without branches, in numbers as wide as the sizes, first: vector instructions.
    std::vector<std::int32_t> isAlike(numbers.second - numbers.first);
    std::int32_t* const to = isAlike.data();
    for (std::size_t i = 0; i < isAlike.size(); ++i) {
        const std::size_t k = numbers.first + i;
        to[i] = std::int32_t{alike(xs[k], x)} & std::int32_t{alike(ys[k], y)} &
                std::int32_t{alike(zs[k], z)};
    }
    for (std::size_t i = 0; i < isAlike.size(); ++i)
        if (isAlike[i]) found.push_back(numbers.first + i);
}
}  // namespace delio::movers
