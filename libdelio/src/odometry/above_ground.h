#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace delio::odometry {
/** Square cells of the level plane, about the origin. */
class LevelGrid {
 public:
    /** Metres: the edge of a cell, and how far the cells reach. */
    LevelGrid(double cell, double radius);

    std::size_t size() const { return cells(width_) * cells(width_); }
    /** Number of the cell, or size() outside. */
    std::size_t at(float x, float y) const;
    /** Calls visit(number) of the cell and of those that touch it. */
    template <typename Visit>
    void forNeighbours(std::size_t cell, const Visit& visit) const {
        const int i = static_cast<int>(cell) / width_, j = static_cast<int>(cell) % width_;
        for (int a = i - 1; a <= i + 1; ++a)
            for (int b = j - 1; b <= j + 1; ++b)
                if (isInside(a, b)) visit(number(a, b));
    }

 private:
    bool isInside(int i, int j) const { return i >= 0 && j >= 0 && i < width_ && j < width_; }
    static std::size_t cells(int count) { return static_cast<std::size_t>(count); }
    std::size_t number(int i, int j) const { return cells(i) * cells(width_) + cells(j); }

    float cell_;
    int half_, width_;
};

/** Height of each point (metres, z up) above the lowest ones in its cell of a metre and those about
 *  it. Negative for points farther than `radius` metres from the origin. */
std::vector<float> heightsAboveGround(const Eigen::Matrix3Xf& points, double radius);

/** The points (metres) that stand more than `least` above the ground within `radius`, by their
 *  columns. `upright` turns their frame such that z is up. */
std::vector<Eigen::Index> standingPoints(const Eigen::Matrix3Xf& points,
                                         const Eigen::Matrix3f& upright, double least,
                                         double radius);
}  // namespace delio::odometry
