#pragma once
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "delio/core/increment.h"

namespace delio::graph {
/** Converts an increment to MRPT's PDF: the covariance is that of the pose's own numbers x y z yaw
 *  pitch roll, x y z along the axes of the earlier frame; metres and radians. At a pitch of +-90
 *  deg, where yaw and roll are one, it does not exist. */
mrpt::poses::CPose3DPDFGaussian posePdfOf(const Increment& increment);
}  // namespace delio::graph
