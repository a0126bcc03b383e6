#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace delio::paper {
/** Directions with a weight each, four side by side, as they are summed up again and again. */
class WeightedDirections {
 public:
    void clear() {
        groups_.clear();
        size_ = 0;
    }
    void add(const Eigen::Vector3f& direction, float weight) {
        const auto in = static_cast<Eigen::Index>(size_++ % kSize);
        if (in == 0) groups_.emplace_back();
        Group& group = groups_.back();
        group.x[in] = direction.x();
        group.y[in] = direction.y();
        group.z[in] = direction.z();
        group.weight[in] = weight;
    }
    std::size_t size() const { return size_; }

    /** Of directions under a kernel. */
    struct Sum {
        Eigen::Vector3f directions;  //!< weighted
        float weight;
        float squares;  //!< of the chords to the kernel's middle, weighted
    };
    /** Those whose chord to `middle` is shorter than the root of `reach`, under a Gaussian that is
     *  `sigma` wide. */
    Sum under(const Eigen::Vector3f& middle, double sigma, double reach) const {
        // Just beyond the reach nothing is left, so steeply does it fall: a choice would cost more.
        // (Nothing is no number that is too small for floats, which are slow.)
        constexpr float kSteep = 1e5F, kNothing = -60;
        const Values nothing = Values::Constant(kNothing).exp();
        const auto scale = static_cast<float>(-0.5 / (sigma * sigma)),
                   inReach = static_cast<float>(1 / reach);
        Values x = Values::Zero(), y = x, z = x, weights = x, squares = x;
        for (const Group& group : groups_) {
            const Values squared = (group.x - middle.x()).square() +
                                   (group.y - middle.y()).square() +
                                   (group.z - middle.z()).square();
            const Values exponent = scale * squared - kSteep * (inReach * squared - 1).max(0);
            const Values weight = group.weight * (exponent.max(kNothing).exp() - nothing);
            x += weight * group.x;
            y += weight * group.y;
            z += weight * group.z;
            weights += weight;
            squares += weight * squared;
        }
        return {{x.sum(), y.sum(), z.sum()}, weights.sum(), squares.sum()};
    }

 private:
    static constexpr std::size_t kSize = 4;
    using Values = Eigen::Array<float, kSize, 1>;
    /** What is not taken has no weight. */
    struct Group {
        Values x = Values::Zero(), y = x, z = x, weight = x;
    };
    std::vector<Group> groups_;
    std::size_t size_ = 0;
};
}  // namespace delio::paper
