#pragma once
#include <cmath>
#include <set>
#include <utility>

#include "mesh.h"
#include "road.h"

namespace delio::synth {
/** The world of a drive, in tiles along the road. A tile depends on the seed, the path and its
 *  index alone, so that only those near the vehicle need to exist. */
class Scene {
 public:
    static constexpr double kTileLength_m = 40;

    explicit Scene(Road road) : road_(std::move(road)) {}
    virtual ~Scene() = default;
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    const Road& road() const { return road_; }
    /** Empty where the road belongs to earlier tiles. */
    virtual Mesh tile(int index) const = 0;
    static int tileAt(double s) { return static_cast<int>(std::floor(s / kTileLength_m)); }
    /** Those that have a road within `reach_m` of where the path is at `s`: where the path comes
     *  back to a place, the tiles that it left there. */
    std::set<int> tilesNear(double s, double reach_m) const {
        std::set<int> tiles;
        for (const double near : road_.stationsNear(road_.point(s, 0), reach_m))
            tiles.insert(tileAt(near));
        return tiles;
    }

 private:
    Road road_;
};
}  // namespace delio::synth
