#pragma once
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace delio::map {
/** Height of the ground around a place, as the low points of each cell of a coarse grid give it,
 *  straight lines between the cells: so that a street on a hill looks like one in the valley. */
class GroundHeight {
 public:
    /** Coordinates of the points, as many of each. */
    template <typename Floats>
    GroundHeight(const Floats& x, const Floats& y, const Floats& z) {
        std::unordered_map<std::uint64_t, std::vector<float>> heights;
        for (std::size_t i = 0; i < x.size(); ++i)
            heights[cellOf(static_cast<double>(x[i]), static_cast<double>(y[i]))].push_back(z[i]);
        for (auto& [key, values] : heights) cells_[key] = lowOf(values);
    }

    double at(double x, double y) const;

 private:
    static std::uint64_t cellOf(double x, double y);
    static double lowOf(std::vector<float>& heights);
    double ofCell(std::int64_t column, std::int64_t row, double otherwise) const;

    std::unordered_map<std::uint64_t, double> cells_;
};
}  // namespace delio::map
