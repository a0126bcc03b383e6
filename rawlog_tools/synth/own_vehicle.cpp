#include "own_vehicle.h"

#include <cmath>

namespace delio::synth {
namespace {
constexpr double kDegree = 3.14159265358979323846 / 180;

/** Degrees below the horizon from which down half of the rays of KITTI's scans are lost (raw drive
 *  2011_09_26_0005 and odometry 00), every 10 deg from 175 deg to the right over ahead to 175 deg
 *  to the left: the boot, an antenna on the right, the bonnet, the rails of the roof. */
constexpr double kNone = 90;
constexpr double kHidden_deg[36] = {
    18,    18.3,  20.3,  24.3,  22.8, 21.3, 24,   24.3, 24.3, 23.5, 15.8, 15,     //
    22,    23.6,  22.2,  23.8,  21,   19.8, 19.8, 21,   23.6, 24.3, 24.3, kNone,  //
    kNone, kNone, kNone, kNone, 24.3, 24.3, 23,   21.5, 24,   22.3, 18.8, 17.8    //
};
}  // namespace

bool behindOwnVehicle(double azimuth_rad, double elevation_rad) {
    if (elevation_rad > -15 * kDegree) return false;
    const double turned = std::remainder(azimuth_rad, 360 * kDegree) / kDegree + 175;
    const double bin = (turned < 0 ? turned + 360 : turned) / 10;
    const auto low = static_cast<int>(bin);
    const double share = bin - low;
    const double hidden = (1 - share) * kHidden_deg[low % 36] + share * kHidden_deg[(low + 1) % 36];
    return elevation_rad < -hidden * kDegree;
}

void castOwnBox(const OwnBox& own, const std::vector<Eigen::Vector3d>& local,
                std::vector<Hit>& hits) {
    constexpr double kReflectivity = 0.3;
    if (own.box.isEmpty()) return;
    const Eigen::Array3d origin = own.sensor.translation().array();
    for (std::size_t i = 0; i < local.size(); ++i) {
        // Where the ray is between each pair of the box's planes.
        const Eigen::Array3d direction = (own.sensor.linear() * local[i]).array();
        const Eigen::Array3d a = (own.box.min().array() - origin) / direction;
        const Eigen::Array3d b = (own.box.max().array() - origin) / direction;
        Eigen::Index face = 0;
        const double enters = a.min(b).maxCoeff(&face), leaves = a.max(b).minCoeff();
        if (!(enters > 0 && enters <= leaves)) continue;
        if (hits[i].range > 0 && hits[i].range < enters) continue;
        hits[i] = {enters, std::abs(direction[face]), kReflectivity, false};
    }
}
}  // namespace delio::synth
