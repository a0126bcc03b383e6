// A sensor without a reader in DeLiO: its driver fills a delio::Scan. Points with times are
// de-skewed. The driver here simulates a 32-ring LiDAR that drives and turns in a hall; the program
// prints its true and its estimated poses.
//   02_own_sensor
#include <delio/odometry/odometry.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <cmath>
#include <cstdio>

/** Pose of the sensor in the hall: 2 m/s forward, 1 rad/s to the left. */
Eigen::Isometry3d poseAt(double time_s) {
    delio::Vector6 velocity;
    velocity << 2, 0, 0, 0, 0, 1;
    return delio::poseExp(time_s * velocity);
}

/** Metres from `from` to the hall's walls, floor and roof in the direction `ray`. */
double rangeAlong(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
    const Eigen::Vector3d low(-15.4, -9.4, -1.7), high(17.3, 11.3, 6.3);
    const Eigen::Array3d wall = (ray.array() > 0).select(high, low);
    return ((wall - from.array()) / ray.array()).abs().minCoeff();
}

/** One turn of the sensor, 0.1 s, stamped in its middle. */
delio::Scan scanOf(std::size_t number) {
    delio::Scan scan;
    scan.index = number;
    scan.stamp_s = 0.1 * static_cast<double>(number);
    scan.time = mrpt::Clock::fromDouble(1.7e9 + scan.stamp_s);
    scan.points = mrpt::maps::CSimplePointsMap::Create();
    for (int column = 0; column < 1000; ++column) {
        const double azimuth = 2 * M_PI * column / 1000, time_s = 0.1 * (column / 1000. - 0.5);
        const Eigen::Isometry3d pose = poseAt(scan.stamp_s + time_s);
        for (int ring = 0; ring < 32; ++ring) {
            const double up = (10 - 1.1 * ring) * M_PI / 180;
            const Eigen::Vector3d ray(std::cos(up) * std::cos(azimuth),
                                      std::cos(up) * std::sin(azimuth), std::sin(up));
            const auto point =
                (ray * rangeAlong(pose.translation(), pose.linear() * ray)).cast<float>().eval();
            scan.points->insertPoint(point.x(), point.y(), point.z());  // metres, sensor's frame
            scan.rings.push_back(static_cast<std::uint16_t>(ring));     // where they are known
            scan.times_s.push_back(static_cast<float>(time_s));         // seconds from the stamp
        }
    }
    return scan;
}

int main() {
    const auto odometry = delio::makeOdometry({});
    Eigen::Isometry3d found = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < 10; ++i)
        found = found * odometry->process(scanOf(i)).increment.pose;
    const Eigen::Isometry3d error = poseAt(0.9).inverse() * found;
    std::printf("way %.3f m, turn %.3f deg, error %.4f m %.4f deg\n", found.translation().norm(),
                delio::angleOf(found.linear()) * 180 / M_PI, error.translation().norm(),
                delio::angleOf(error.linear()) * 180 / M_PI);
}
