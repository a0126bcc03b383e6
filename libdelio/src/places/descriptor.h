#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/voxel_table.h"
#include "paper/normals.h"

namespace delio::places {
/** Number of bits that are set. Without a table, so that the compiler can vectorise it. */
constexpr std::uint8_t bitsOf(std::uint8_t bands) {
    const auto pairs = static_cast<std::uint8_t>(bands - ((bands >> 1) & 0x55));
    const auto fours = static_cast<std::uint8_t>((pairs & 0x33) + ((pairs >> 2) & 0x33));
    return static_cast<std::uint8_t>((fours + (fours >> 4)) & 0x0F);
}

/** Wall-orientation histogram of a levelled cloud: azimuths of the normals that are nearly level,
 * over half a turn (a wall may be seen from either side), smoothed. No translation changes it. */
class WallOrientations {
 public:
    static constexpr Eigen::Index kBins = 720;  //!< of half a turn

    /** Descriptor of the normals of a levelled cloud. */
    explicit WallOrientations(const paper::SurfaceNormals& surfaces);
    /** From another one's weights(). */
    static WallOrientations ofWeights(Eigen::VectorXd weights) {
        WallOrientations walls;
        walls.weights_ = std::move(weights);
        return walls;
    }

    /** Of each direction. */
    const Eigen::VectorXd& weights() const { return weights_; }

    /** Rotations of `other` about z (radians) at which the two histograms correlate best, the best
     *  first: the highest `most` local maxima within `reach` of `expected`. Ends of that interval
     * do not count as maxima. Only `expected` decides between rotations half a turn apart. Empty if
     *  one of the two has no walls. */
    std::vector<double> turnsOf(const WallOrientations& other, double expected, double reach,
                                std::size_t most) const;

 private:
    WallOrientations() = default;

    Eigen::VectorXd weights_;
};

/** A levelled cloud without ceilings, seen from above: for each cell, a bit for each height band
 * above the local ground that has points. Absolute height, which drifts most, has no influence. */
class HeightImage {
 public:
    static constexpr double kCell_m = 0.5;  //!< edge of a cell, metres

    /** `points`: metres, z up. */
    explicit HeightImage(const Eigen::Matrix3Xf& points);
    /** From another one's cells(), bands(), grounds() and heights(). */
    HeightImage(const Eigen::Matrix2Xd& cells, std::vector<std::uint8_t> bands,
                Eigen::Matrix2Xd grounds, std::vector<double> heights);

    /** Centres of the cells in which something stands: x and y, metres. */
    Eigen::Matrix2Xd cells() const { return kCell_m / 2 * halves_.cast<double>(); }
    /** Of each of the cells, a bit for each height band. */
    const std::vector<std::uint8_t>& bands() const { return bands_; }
    /** Height of the ground about that place, metres; NaN where none was seen. */
    double groundAt(double x, double y) const;
    /** Centres of the blocks whose ground was seen. */
    const Eigen::Matrix2Xd& grounds() const { return grounds_; }
    /** Of that ground, metres. */
    const std::vector<double>& heights() const { return heights_; }

 private:
    /** Values of cells(), in halves of a cell, to save memory: a long drive has thousands of
     *  images. */
    Eigen::Matrix<std::int16_t, 2, Eigen::Dynamic> halves_;
    Eigen::Matrix2Xd grounds_;
    std::vector<std::uint8_t> bands_;
    std::vector<double> heights_;
    VoxelIndex groundIndex_;
};

/** The points of a levelled cloud that are above the ground. */
Eigen::Matrix3Xd aboveGround(const Eigen::Matrix3Xf& points);
/** Of these, the points that are no ceiling: a ceiling matches anywhere in a building. */
Eigen::Matrix3Xd standing(const Eigen::Matrix3Xf& points);

/** A pose of one height image on another. */
struct Shift {
    double yaw = 0;                                         //!< rad, about z
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();  //!< other to this, metres
    /** Overlap coefficient of the bands: common ones divided by those of the smaller image, 0 to 1.
     */
    double overlap = 0;
};

/** Shifts of `other` onto `image` within `reach` metres of `expected`: the best, and others at
 * least `apart` metres from better ones, the best first, `most` of them; heights by the ground that
 * both see. */
std::vector<Shift> shiftsOf(const HeightImage& image, const HeightImage& other, double yaw,
                            const Eigen::Vector2d& expected, double reach, double apart,
                            std::size_t most);

/** Cells of a height image in memory as they lie, with an empty margin. */
struct Raster {
    int x0 = 0;  //!< index of the first column
    int y0 = 0;  //!< index of the first row
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bands;  //!< of each cell, row by row

    Raster() = default;
    /** `cells`: indices x, y of each of `bands`. Bands of one cell are put together. */
    Raster(const Eigen::Matrix2Xi& cells, const std::vector<std::uint8_t>& itsBands, int margin);

    /** Number of the cell in column x and row y, both from 0. */
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
    /** `count` cells of row y from column x on, both as indices of cells; null where they are not
     *  all there. */
    const std::uint8_t* row(int x, int y, int count) const {
        if (x < x0 || y < y0 || y - y0 >= height || x - x0 + count > width) return nullptr;
        return bands.data() + at(x - x0, y - y0);
    }
};

/** One normal per flat voxel of 1 m, weighted by its number of points; metres. */
paper::SurfaceNormals flatVoxels(const Eigen::Matrix3Xf& points);

/** Submap descriptor: wall orientations and height image. */
struct Descriptor {
    WallOrientations walls;  //!< for the rotation
    HeightImage image;       //!< for the translation

    /** Of a levelled cloud, metres. */
    explicit Descriptor(const Eigen::Matrix3Xf& points);
    /** Of what another one was made of. */
    Descriptor(WallOrientations itsWalls, HeightImage itsImage)
        : walls(std::move(itsWalls)), image(std::move(itsImage)) {}
};
}  // namespace delio::places
