#pragma once
#include <cmath>
#include <vector>

#include "delio/core/geometry.h"
#include "ring_scan.h"

namespace delio::test {
/** Angles (radians) at which formulas of rotations tend to break: none, tiny, either side of where
 *  a series takes over, ordinary ones, and close to half a turn. */
inline std::vector<double> criticalAngles() {
    return {0,    1e-300, 1e-12, 1e-8, 0.99e-4, 1.01e-4,     1.99e-4,     2.01e-4,
            1e-3, 0.1,    1,     2,    3,       M_PI - 1e-3, M_PI - 1e-6, M_PI - 1e-9};
}

/** Along the axes, between them, and anywhere. */
inline std::vector<Eigen::Vector3d> directions() {
    std::vector<Eigen::Vector3d> result = {{1, 0, 0}, {0, -1, 0}, {0, 0, 1},
                                           {1, 1, 1}, {-1, 0, 1}, {1e-9, 1, 0}};
    Noise noise;
    for (int i = 0; i < 8; ++i) result.push_back(noise.direction());
    for (auto& direction : result) direction.normalize();
    return result;
}

/** Twists of one rate of turn (rad) and of velocities (m) from none to many. */
inline std::vector<Vector6> twistsOf(double angle) {
    Noise noise(3);
    std::vector<Vector6> result;
    for (const auto& axis : directions())
        for (const double length : {0.0, 1e-8, 1.0, 100.0}) {
            result.emplace_back();
            result.back() << length * noise.direction(), angle * axis;
        }
    return result;
}

/** Central differences of f: R^N -> R^M at 0. */
template <int N, typename Function>
auto jacobianOf(const Function& f, double h = 1e-5) {
    using Input = Eigen::Matrix<double, N, 1>;
    using Output = decltype(f(Input()));
    Eigen::Matrix<double, Output::RowsAtCompileTime, N> result;
    for (int k = 0; k < N; ++k) {
        const Input step = h * Input::Unit(k);
        result.col(k) = (f(step) - f(-step)) / (2 * h);
    }
    return result;
}
}  // namespace delio::test
