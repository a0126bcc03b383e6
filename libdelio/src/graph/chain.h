#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "delio/core/geometry.h"

namespace delio::graph {
/** Covariances of the steps between successive nodes, summed up along the chain. */
class Chain {
 public:
    /** Chain of `nodes` nodes; steps are exact until set() is called. */
    explicit Chain(std::size_t nodes) : sums_(nodes, Matrix6::Zero()) {}

    /** The step from node `step` to the next: `covariance` in the frame of a node at `pose`. Before
     *  sumUp(). */
    void set(std::size_t step, const Matrix6& covariance, const Eigen::Isometry3d& pose) {
        const Matrix6 A = adjointOf(pose);
        sums_[step + 1] = A * covariance * A.transpose();
    }
    /** Call it once, after all steps are set. */
    void sumUp() {
        for (std::size_t i = 1; i < sums_.size(); ++i) sums_[i] += sums_[i - 1];
    }
    /** Covariance of the motion between two nodes, about the world's origin. */
    Matrix6 between(std::size_t first, std::size_t last) const {
        return sums_[last] - sums_[first];
    }

 private:
    std::vector<Matrix6> sums_;  //!< up to each node
};
}  // namespace delio::graph
