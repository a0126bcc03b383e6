#pragma once
#include <cmath>
#include <utility>

#include "mesh.h"
#include "road.h"

namespace delio::synth {
/** The world of a drive, in tiles along the road. A tile depends on the seed and its index alone,
 *  so that only those near the vehicle need to exist. */
class Scene {
 public:
    static constexpr double kTileLength_m = 40;

    explicit Scene(Road road) : road_(std::move(road)) {}
    virtual ~Scene() = default;
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const Road& road() const { return road_; }
    virtual Mesh tile(int index) const = 0;
    static int tileAt(double s) { return static_cast<int>(std::floor(s / kTileLength_m)); }

 private:
    Road road_;
};
}  // namespace delio::synth
