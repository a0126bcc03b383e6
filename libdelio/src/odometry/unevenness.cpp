#include "delio/odometry/unevenness.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "delio/core/geometry.h"

namespace delio {
namespace {
constexpr std::size_t kMemory = 20, kEnough = 3;

void remember(double square, std::deque<double>& squares) {
    squares.push_back(square / 3);
    if (squares.size() > kMemory) squares.pop_front();
}

/** With one of `likely` more, while there are few. */
double meanRoot(const std::deque<double>& squares, double likely) {
    const std::size_t more = squares.size() < kEnough ? 1 : 0;
    const double sum = std::accumulate(squares.begin(), squares.end(),
                                       static_cast<double>(more) * likely * likely);
    return std::sqrt(sum / static_cast<double>(squares.size() + more));
}
}  // namespace

void Unevenness::observe(const Eigen::Isometry3d& found, const Eigen::Isometry3d& even) {
    const Eigen::Isometry3d off = even.inverse() * found;
    remember(off.translation().squaredNorm(), squares_m2_);
    remember(std::pow(angleOf(off.linear()), 2), squares_rad2_);
}

planes::CoursePrior Unevenness::prior(double most) const {
    constexpr double kLikely_m = 0.02, kLikely_rad = 3 * M_PI / 180;
    constexpr double kLeast_m = 1e-4, kLeast_rad = 1e-5;  // of a sensor that stands still
    planes::CoursePrior prior;
    prior.unevenTranslation =
        std::clamp(meanRoot(squares_m2_, kLikely_m), kLeast_m, std::max(most, kLeast_m));
    prior.unevenRotation = std::max(meanRoot(squares_rad2_, kLikely_rad), kLeast_rad);
    return prior;
}
}  // namespace delio
