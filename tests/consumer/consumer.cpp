// Two scans of the inside of a box, the sensor turned by 5 deg, through the installed library.
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "delio/odometry/aligner.h"
#include "delio/odometry/odometry.h"
#include "delio/slam/options.h"

namespace {
/** 32 rings of a LiDAR, turned by `yaw`, in a box: walls 15 m, 15 m, 7 m and 9 m away, floor 1.7 m
 *  below, roof 6 m above. */
delio::Scan scanAt(double yaw) {
    auto points = mrpt::maps::CSimplePointsMap::Create();
    delio::Scan scan;
    for (int ring = 0; ring < 32; ++ring)
        for (int column = 0; column < 1000; ++column) {
            const double elevation = (10 - 1.1 * ring) * M_PI / 180;
            const double azimuth = 2 * M_PI * column / 1000;
            const double flat = std::cos(elevation), up = std::sin(elevation);
            const double x = flat * std::cos(azimuth + yaw), y = flat * std::sin(azimuth + yaw);
            const double range = std::min({15 / std::abs(x), (y > 0 ? 7 : 9) / std::abs(y),
                                           (up > 0 ? 6 : 1.7) / std::abs(up)});
            points->insertPoint(static_cast<float>(range * flat * std::cos(azimuth)),
                                static_cast<float>(range * flat * std::sin(azimuth)),
                                static_cast<float>(range * up));
            scan.rings.push_back(static_cast<std::uint16_t>(ring));
        }
    scan.points = points;
    return scan;
}
}  // namespace

int main() {
    constexpr double kYaw = 5 * M_PI / 180;
    delio::Odometry odometry(delio::Options::ofProfile("paper").odometry);
    odometry.process(scanAt(0));
    const auto result = odometry.process(scanAt(kYaw));
    const auto& pose = result.increment.pose;
    std::printf("installed library: turned %.3f deg, moved %.3f m\n", pose.yaw() * 180 / M_PI,
                pose.norm());
    const auto isRight = [&](const mrpt::poses::CPose3D& found) {
        return std::abs(found.yaw() - kYaw) < 0.2 * M_PI / 180 && found.norm() < 0.02;
    };
    const auto aligned =
        delio::Aligner()
            .Align3D(scanAt(0).points.get(), scanAt(kYaw).points.get(), mrpt::poses::CPose3D())
            ->getMeanVal();
    return !result.predicted && isRight(pose) && isRight(aligned) ? 0 : 1;
}
