#pragma once
#include <deque>
#include <functional>
#include <memory>

#include "delio/loops/closure.h"
#include "delio/loops/free_space.h"

namespace delio::loops {
/** What others are registered to and compared with: 10 to 20 MB for a submap. */
struct Ground {
    RegistrableSubmap map;  //!< its points and planes
    FreeSpace free;         //!< what it saw to be empty

    /** `image`: of the same points. */
    Ground(const Eigen::Matrix3Xf& points, const HeightImage& image)
        : map(points), free(image, points) {}
};

/** Of many submaps those that were needed last. */
class Grounds {
 public:
    /** Keeps so many. */
    explicit Grounds(std::size_t most) : most_(most) {}

    /** `make`: where it was not needed lately. */
    std::shared_ptr<const Ground> at(std::size_t submap, const std::function<Ground()>& make);

 private:
    struct Recent {
        std::size_t submap;
        std::shared_ptr<const Ground> ground;
    };
    std::size_t most_;
    std::deque<Recent> recent_;  //!< the latest first
};
}  // namespace delio::loops
