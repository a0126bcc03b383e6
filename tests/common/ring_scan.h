#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "delio/odometry/scan.h"
#include "poses.h"

namespace delio::test {
/** Numbers that are the same wherever the test runs, which std's distributions are not. */
class Noise {
 public:
    explicit Noise(std::uint32_t seed = 7) : engine_(seed) {}
    double uniform() { return static_cast<double>(engine_()) / 2147483648.0 - 1; }  //!< [-1, 1)
    double normal();  //!< nearly normal, variance 1, never beyond 6
    Eigen::Vector3d normals();
    Eigen::Vector3d direction();  //!< anywhere on the unit sphere

 private:
    std::mt19937 engine_;
};

Eigen::Matrix3d rotationAbout(const Eigen::Vector3d& axis, double degrees);

/** A block with its faces along the axes; rays meet it from outside or from inside. */
struct Block {
    Eigen::Vector3d low, high;
};
using Scene = std::vector<Block>;

/** Ground, walls, and blocks of several sizes about the origin, none of them repeated; free within
 *  5 m of the x axis between -5 and 20 m. The ground is at z = -1.8. */
Scene yard();
/** A closed room of 21 m by 15 m with a few cupboards: floor, ceiling and walls in equal parts. */
Scene room();
/** A ground and two parallel walls along x, without an end. */
Scene corridor();
/** Ground and rails along x, which look the same from anywhere on the road, and bushes or none. */
Scene highway(bool bushes);

struct Sensor {
    unsigned rings = 32;
    unsigned columns = 720;
    double lowest_deg = -24;
    double highest_deg = 8;
    double noise_m = 0;  //!< of the range
    /** From the top; where given, the beams in place of those that are evenly spread. */
    std::vector<double> elevations_deg = {};
};

/** What the sensor sees at `pose`: ring after ring, the uppermost first, each once round
 *  (counter-clockwise from azimuth 0). Rays that meet nothing give no point. */
struct RingScan {
    Eigen::Matrix3Xf points;
    std::vector<std::uint16_t> rings;
};
RingScan ringScan(const Scene& scene, const Eigen::Isometry3d& pose, const Sensor& sensor,
                  Noise& noise);

/** As a rawlog gives it, without its rings. */
Scan scanOf(const Eigen::Matrix3Xf& points);
}  // namespace delio::test
