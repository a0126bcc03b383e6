#pragma once
#include <mrpt/maps/CPointsMap.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace delio::map {
/** Height of the ground around a place, as the low points of each cell of a coarse grid give it,
 *  straight lines between the cells: so that a street on a hill looks like one in the valley. */
class GroundHeight {
 public:
    explicit GroundHeight(const mrpt::maps::CPointsMap& points);

    double at(double x, double y) const;

 private:
    double ofCell(std::int64_t column, std::int64_t row, double otherwise) const;

    std::unordered_map<std::uint64_t, double> cells_;
};
}  // namespace delio::map
