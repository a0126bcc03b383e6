// Two scans of the inside of a box, half a metre apart, through the installed library.
#include <mrpt/maps/CSimplePointsMap.h>

#include <cmath>
#include <cstdio>

#include "delio/odometry.h"
#include "delio/profile.h"

namespace {
/** 32 rings of a LiDAR at (x, 1, 0) in a box of 30 m x 16 m, floor 1.7 m below, roof 6 m above. */
delio::Scan scanFrom(double x) {
    auto points = mrpt::maps::CSimplePointsMap::Create();
    delio::Scan scan;
    for (int ring = 0; ring < 32; ++ring)
        for (int column = 0; column < 1000; ++column) {
            const double elevation = (10 - 1.1 * ring) * M_PI / 180;
            const double azimuth = 2 * M_PI * column / 1000;
            const double dx = std::cos(elevation) * std::cos(azimuth);
            const double dy = std::cos(elevation) * std::sin(azimuth);
            const double dz = std::sin(elevation);
            const double range =
                std::min({(dx > 0 ? 15 - x : 15 + x) / std::abs(dx),
                          (dy > 0 ? 7 : 9) / std::abs(dy), (dz > 0 ? 6 : 1.7) / std::abs(dz)});
            points->insertPoint(static_cast<float>(range * dx), static_cast<float>(range * dy),
                                static_cast<float>(range * dz));
            scan.rings.push_back(static_cast<std::uint16_t>(ring));
        }
    scan.points = points;
    return scan;
}
}  // namespace

int main() {
    delio::Odometry odometry(delio::Options::ofProfile("paper").odometry);
    odometry.process(scanFrom(0));
    const auto result = odometry.process(scanFrom(0.5));
    std::printf("installed library: moved %.3f %.3f %.3f m\n", result.increment.pose.x(),
                result.increment.pose.y(), result.increment.pose.z());
    const bool right = !result.predicted && std::abs(result.increment.pose.x() - 0.5) < 0.02 &&
                       std::abs(result.increment.pose.y()) < 0.02;
    return right ? 0 : 1;
}
