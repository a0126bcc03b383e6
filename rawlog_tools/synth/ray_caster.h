#pragma once
#include <Eigen/Core>
#include <map>
#include <memory>
#include <vector>

#include "mesh.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace delio::synth {
/** Hit of a ray; no range without a hit. */
struct Hit {
    double range = 0;
    double cosIncidence = 0;
    double reflectivity = 0;
    bool moving = false;  //!< it was a vehicle or a person of the traffic
};

struct Ray {
    Eigen::Vector3d origin, direction;  //!< the direction is a unit vector
};

/** Finds the first triangle on a ray, with Embree. The instruction set and the building thread are
 *  fixed, and Embree only chooses the triangle: the range is computed from it in double precision.
 */
class RayCaster {
 public:
    RayCaster();
    ~RayCaster();
    RayCaster(const RayCaster&) = delete;
    RayCaster& operator=(const RayCaster&) = delete;

    void add(int id, Mesh mesh);
    void remove(int id);
    bool has(int id) const { return meshes_.count(id) != 0; }
    /** The ids of all meshes, in order. */
    std::vector<int> ids() const;
    /** Call it after adding or removing meshes, before casting rays. */
    void commit();

    /** May be called by several threads. */
    void cast(const std::vector<Ray>& rays, double maxRange, std::vector<Hit>& hits) const;
    /** The same for rays from one place. */
    void cast(const Eigen::Vector3d& origin, const std::vector<Eigen::Vector3d>& directions,
              double maxRange, std::vector<Hit>& hits) const;

 private:
    struct Attached {
        unsigned geometry;
        Mesh mesh;
    };
    Hit exactHit(const Ray& ray, unsigned geometry, unsigned triangle, double found) const;

    RTCDeviceTy* device_;
    RTCSceneTy* scene_;
    std::map<int, Attached> meshes_;
    std::vector<const Mesh*> byGeometry_;
};
}  // namespace delio::synth
