#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "random.h"
#include "ray_caster.h"
#include "sensor_model.h"

namespace delio::synth {
/** Makes scans: casts the sensor's rays and adds what a real sensor adds. */
class Scanner {
 public:
    Scanner(const RayCaster& caster, SensorModel sensor, double noise_m, std::uint64_t seed,
            int threads)
        : caster_(caster),
          sensor_(std::move(sensor)),
          noise_m_(noise_m),
          seed_(seed),
          threads_(threads) {}

    /** KITTI's floats x y z intensity: ring after ring, the top one first, each from straight ahead
     *  to the left and round. Depends on the seed and `scan`, not on the number of threads. */
    std::vector<float> scan(const Eigen::Isometry3d& lidarToWorld, std::size_t scan) const;

 private:
    void scanRing(const Eigen::Isometry3d& lidarToWorld, std::size_t scan, std::size_t ring,
                  std::vector<float>& xyzi) const;

    const RayCaster& caster_;
    SensorModel sensor_;
    double noise_m_;
    std::uint64_t seed_;
    int threads_;
};

/** How likely an echo is to be noticed. */
double detectionProbability(const Hit& hit);
/** Of an echo, 0 ... 1, in KITTI's steps of 0.01. `gain`: of the laser. */
float intensity(const Hit& hit, double gain, Random& random);
/** The vehicle's own bonnet and boot hide what is below them. */
bool behindOwnVehicle(double azimuth, double elevation);
}  // namespace delio::synth
