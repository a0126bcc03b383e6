#pragma once
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <Eigen/Geometry>
#include <random>

#include "delio/map/map_builder.h"

namespace delio::test {
inline const auto kStamp = mrpt::Clock::fromDouble(1316995200.0);
inline const Eigen::Isometry3d kHere = Eigen::Isometry3d::Identity();

/** Within `reach` metres over the ground and a tenth of that in height. */
inline mrpt::maps::CPointsMapXYZI randomCloud(std::size_t count, unsigned seed, float reach = 20) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> place(-reach, reach), intensity(0, 1);
    mrpt::maps::CPointsMapXYZI cloud;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = place(random), y = place(random), z = place(random) / 10;
        cloud.insertPointRGB(x, y, z, intensity(random), 0, 0);
    }
    return cloud;
}

/** Every point of every scan that was not told to move. */
inline map::MapOptions everything() {
    map::MapOptions options;
    options.voxelSize_m = 0;
    options.minRange_m = 0;
    options.maxRange_m = 1e6;
    options.removal.enabled = false;
    return options;
}
}  // namespace delio::test
