#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace delio::map {
/** Height of the ground around a place, as the low points of each cell of a coarse grid give it,
 *  straight lines between the cells: so that a street on a hill looks like one in the valley. */
class GroundHeight {
 public:
    /** Of `count` points; pointAt(i) is an Eigen::Vector3f. */
    template <typename PointAt>
    GroundHeight(std::size_t count, const PointAt& pointAt) {
        std::unordered_map<std::uint64_t, std::vector<float>> heights;
        for (std::size_t i = 0; i < count; ++i) {
            const Eigen::Vector3f p = pointAt(i);
            heights[cellOf(double{p.x()}, double{p.y()})].push_back(p.z());
        }
        for (auto& [key, values] : heights) cells_[key] = lowOf(values);
    }

    double at(double x, double y) const;

 private:
    static std::uint64_t cellOf(double x, double y);
    static double lowOf(std::vector<float>& heights);
    double ofCell(std::int64_t column, std::int64_t row, double otherwise) const;

    std::unordered_map<std::uint64_t, double> cells_;
};

/** Of each point above the ground around it. */
template <typename PointAt>
std::vector<float> heightsAboveGround(std::size_t count, const PointAt& pointAt) {
    const GroundHeight ground(count, pointAt);
    std::vector<float> heights(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Vector3f p = pointAt(i);
        heights[i] = static_cast<float>(double{p.z()} - ground.at(double{p.x()}, double{p.y()}));
    }
    return heights;
}
}  // namespace delio::map
