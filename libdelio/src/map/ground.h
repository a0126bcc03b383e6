#pragma once
#include <Eigen/Core>

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "delio/map/map_point.h"

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

    /** Height of a point above it. */
    double above(const Eigen::Vector3f& p) const {
        return double{p.z()} - at(double{p.x()}, double{p.y()});
    }

 private:
    static std::uint64_t cellOf(double x, double y);
    static double lowOf(std::vector<float>& heights);
    double ofCell(std::int64_t column, std::int64_t row, double otherwise) const;

    std::unordered_map<std::uint64_t, double> cells_;
};

/** Height of each point above the surrounding ground. */
template <typename PointAt>
std::vector<float> heightsAboveGround(std::size_t count, const PointAt& pointAt) {
    const GroundHeight ground(count, pointAt);
    std::vector<float> heights(count);
    for (std::size_t i = 0; i < count; ++i)
        heights[i] = static_cast<float>(ground.above(pointAt(i)));
    return heights;
}

/** Ground height below the points, to find objects that stand on it: the low points of each cell,
 *  but not more above those of the cells around than a steep street would be (which excludes car
 *  roofs), nor far below them (reflections in wet streets); straight lines between the cells. */
class GroundSurface {
 public:
    /** @param cell edge of a cell in metres; the points' extent has to have less than 2^31 cells */
    GroundSurface(const MapPoints& points, double cell);

    /** NaN if no surrounding cell has points. */
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
    /** Surrounding cells of about the same height. */
    template <typename Visit>
    void visitNeighbours(std::uint32_t cell, const Visit& visit) const;

    double cell_;
    std::int64_t firstColumn_ = 0, firstRow_ = 0, columns_ = 0, rows_ = 0;
    std::vector<float> heights_;  //!< NaN: no points
    std::vector<bool> isGround_;
};
}  // namespace delio::map
