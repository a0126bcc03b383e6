#pragma once
#include <Eigen/Geometry>

#include "delio/loops/height_image.h"

namespace delio::loops {
/** Where a levelled cloud, seen from above, has ground and nothing on it. */
class FreeSpace {
 public:
    /** `image`: of the same points. */
    FreeSpace(const HeightImage& image, const Eigen::Matrix3Xf& points);

    /** Of the cells where another cloud has something of 1 to 4 m without a gap (a wall, a hedge, a
     *  trunk), and this one saw what is there, the share where this one saw bare ground; 0 where
     *  nothing can be compared. `pose`: other to this. */
    double builtOn(const HeightImage& other, const Eigen::Isometry3d& pose) const;

 private:
    VoxelIndex bare_, standing_;  //!< cells: ground with nothing on it or beside it; others
};
}  // namespace delio::loops
