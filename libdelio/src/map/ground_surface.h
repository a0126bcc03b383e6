#pragma once
#include <cstdint>
#include <vector>

#include "delio/map/map_point.h"

namespace delio::map {
/** The ground below the points, for telling what stands on it: the low points of each cell, but
 *  not more above those of the cells around than a steep street would be (so that the roof of a car
 *  is none), nor far below them (reflections in wet streets); straight lines between the cells. */
class GroundSurface {
 public:
    /** @param cell edge of a cell in metres; the points' extent has to have less than 2^31 cells */
    GroundSurface(const MapPoints& points, double cell);

    /** Where no cell around has points, NaN. */
    double at(double x, double y) const;

    /** False where the low points are an island of a few square metres: the top of a tree or a
     *  wall that was seen from afar, the ground below them was not. */
    bool isGround(double x, double y) const;

 private:
    struct Low {
        std::uint32_t cell;
        float height;
    };
    std::uint32_t cellOf(const Eigen::Vector3f& point) const;
    float height(std::int64_t column, std::int64_t row) const;
    std::vector<Low> lowsOf(const MapPoints& points) const;
    void liftPits(std::vector<Low>& lows);
    void lowerWhatStandsOut(std::vector<Low>& lows);
    void findIslands(const std::vector<Low>& lows);
    /** Those around it that go on at about its height. */
    template <typename Visit>
    void visitNeighbours(std::uint32_t cell, const Visit& visit) const;

    double cell_;
    std::int64_t firstColumn_ = 0, firstRow_ = 0, columns_ = 0, rows_ = 0;
    std::vector<float> heights_;  //!< NaN: no points
    std::vector<bool> isGround_;
};
}  // namespace delio::map
