#pragma once
#include <Eigen/Core>

#include "bytes.h"

namespace delio {
/** Points within 160 m of the origin, rounded to 5 mm, in the order of small cells, so that they
 *  pack well; those farther off are left out. */
void put(ByteWriter& bytes, const Eigen::Matrix3Xf& points);
Eigen::Matrix3Xf getPoints(ByteReader& bytes);
}  // namespace delio
