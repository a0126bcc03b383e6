#pragma once
#include <Eigen/Core>
#include <utility>
#include <vector>

#include "paper/normals.h"

namespace delio::loops {
/** Which way the walls of a levelled cloud look, whichever place it was seen from: a histogram of
 *  the azimuths of the normals that are nearly level, over half a turn (a wall is seen from either
 *  side), smoothed. */
class Azimuths {
 public:
    static constexpr Eigen::Index kBins = 720;  //!< of half a turn

    /** Of the normals of a levelled cloud. */
    explicit Azimuths(const paper::SurfaceNormals& surfaces);
    /** Of what weights() of another one gave. */
    static Azimuths ofWeights(Eigen::VectorXd weights) {
        Azimuths azimuths;
        azimuths.weights_ = std::move(weights);
        return azimuths;
    }

    /** Of each direction. */
    const Eigen::VectorXd& weights() const { return weights_; }

    /** Rotations about z (radians) of `other`, by which it looks most like this one, the best
     * first: the highest `most` maxima of the circular correlation within `reach` of `expected`,
     * and the nearest ends of that interval are none. Rotations half a turn apart are told apart by
     *  `expected` alone. Empty where one of the two has no walls. */
    std::vector<double> turnsOf(const Azimuths& other, double expected, double reach,
                                std::size_t most) const;

 private:
    Azimuths() = default;

    Eigen::VectorXd weights_;
};
}  // namespace delio::loops
