#pragma once
#include <gtest/gtest.h>

#include <random>

#include "delio/map/map_point.h"

namespace delio::test {
inline map::MapPoint pointAt(double x, double y, double z) {
    map::MapPoint point;
    point.position = Eigen::Vector3d(x, y, z).cast<float>();
    return point;
}

/** Points with all that can be known of one. */
inline map::MapPoints somePoints(std::size_t count = 1000) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-4000, 4000), unit(0, 1);
    map::MapPoints points(count);
    for (auto& point : points) {
        point.position = {place(random), place(random), place(random)};
        point.normal = Eigen::Vector3f(place(random), place(random), place(random)).normalized();
        point.intensity = unit(random);
        point.time_s = place(random);
        point.residual_m = unit(random);
        point.observations = static_cast<std::uint16_t>(random());
    }
    return points;
}

inline void expectEqual(const map::MapPoints& a, const map::MapPoints& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(a[i].position, b[i].position) << i;
        ASSERT_EQ(a[i].normal, b[i].normal) << i;
        ASSERT_EQ(a[i].intensity, b[i].intensity) << i;
        ASSERT_EQ(a[i].time_s, b[i].time_s) << i;
        ASSERT_EQ(a[i].residual_m, b[i].residual_m) << i;
        ASSERT_EQ(a[i].observations, b[i].observations) << i;
    }
}
}  // namespace delio::test
