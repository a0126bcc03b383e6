#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/voxel_table.h"

namespace delio::loops {
/** A levelled cloud seen from above: of each cell, at which heights above the ground beside there
 *  is something (a bit each). What drifts most, the height, is not in it. */
class HeightImage {
 public:
    static constexpr double kCell_m = 0.5;  //!< edge of a cell, metres

    /** `points`: metres, z up. */
    explicit HeightImage(const Eigen::Matrix3Xf& points);
    /** Of what cells(), bands(), grounds() and heights() of another one gave. */
    HeightImage(const Eigen::Matrix2Xd& cells, std::vector<std::uint8_t> bands,
                Eigen::Matrix2Xd grounds, std::vector<double> heights);

    /** Where something stands; x and y of the cell's centre, in metres. */
    Eigen::Matrix2Xd cells() const { return kCell_m / 2 * halves_.cast<double>(); }
    /** Of each cell, a bit a height. */
    const std::vector<std::uint8_t>& bands() const { return bands_; }
    /** Height of the ground about that place, metres; NaN where none was seen. */
    double groundAt(double x, double y) const;
    /** Centres of the blocks whose ground was seen. */
    const Eigen::Matrix2Xd& grounds() const { return grounds_; }
    /** Of that ground, metres. */
    const std::vector<double>& heights() const { return heights_; }

 private:
    /** What cells() gives, in halves of a cell: a long drive has thousands of images. */
    Eigen::Matrix<std::int16_t, 2, Eigen::Dynamic> halves_;
    Eigen::Matrix2Xd grounds_;
    std::vector<std::uint8_t> bands_;
    std::vector<double> heights_;
    VoxelIndex groundIndex_;
};

/** Of a levelled cloud the points of what stands on the ground. */
Eigen::Matrix3Xd aboveGround(const Eigen::Matrix3Xf& points);

/** Where the other image, turned by `yaw`, lies on this one. */
struct Shift {
    double yaw = 0;                                         //!< rad, about z
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  //!< other to this, metres
    /** Of the bands of that one which has fewer, so many meet some of the other's; 0 to 1. */
    double share = 0;
};

/** Shifts of `other` onto `image` within `reach` metres of `expected`: the best, and others at
 * least `apart` metres from better ones, the best first, `most` of them; heights by the ground that
 * both see. */
std::vector<Shift> shiftsOf(const HeightImage& image, const HeightImage& other, double yaw,
                            const Eigen::Vector2d& expected, double reach, double apart,
                            std::size_t most);
}  // namespace delio::loops
