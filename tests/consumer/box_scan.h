#pragma once
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>

#include "delio/scan/scan.h"

/** 32 rings of a LiDAR, turned by `yaw`, in a box: walls 15.4 m, 15.4 m, 7.3 m and 9.4 m away,
 * floor 1.7 m below, roof 6.3 m above (none at whole metres, where voxels of the map end).
 * `number`: of the scan, ten a second. */
inline delio::Scan scanAt(double yaw, std::size_t number = 0) {
    auto points = mrpt::maps::CSimplePointsMap::Create();
    delio::Scan scan;
    scan.index = number;
    scan.stamp_s = 0.1 * static_cast<double>(number);
    scan.time = mrpt::Clock::fromDouble(1e9 + scan.stamp_s);
    for (int ring = 0; ring < 32; ++ring)
        for (int column = 0; column < 1000; ++column) {
            const double elevation = (10 - 1.1 * ring) * M_PI / 180;
            const double azimuth = 2 * M_PI * column / 1000;
            const double flat = std::cos(elevation), up = std::sin(elevation);
            const double x = flat * std::cos(azimuth + yaw), y = flat * std::sin(azimuth + yaw);
            const double range = std::min({15.4 / std::abs(x), (y > 0 ? 7.3 : 9.4) / std::abs(y),
                                           (up > 0 ? 6.3 : 1.7) / std::abs(up)});
            points->insertPoint(static_cast<float>(range * flat * std::cos(azimuth)),
                                static_cast<float>(range * flat * std::sin(azimuth)),
                                static_cast<float>(range * up));
            scan.rings.push_back(static_cast<std::uint16_t>(ring));
        }
    scan.points = points;
    return scan;
}
