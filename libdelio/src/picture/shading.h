#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/math/CMatrixDynamic.h>

#include "delio/picture/render.h"
#include "picture/view.h"

namespace delio::picture {
/** Depth of the background. */
constexpr float kNoDepth = 0;

/** Turns the depth that MRPT renders into the binary logarithm of the distance from the camera,
 *  and in parallel projection, where the camera may stand anywhere, into what has the same
 *  differences about the middle of a perspective view of the same size. Finite where something is
 *  to be seen, infinite elsewhere. */
void toLogDepth(mrpt::math::CMatrixFloat& depth, const View& view, const SnapshotOptions& options);

/** How much is shaded, and how far around a pixel others are looked for. */
struct EyeDome {
    double gain = 300;     //!< of the mean difference of logarithms; 0: none
    double radius_px = 1;  //!< and twice of it
    /** Differences up to this one, a radius away, may be a surface's slope: where the other side
     *  falls off as much, it is one, and is not shaded. */
    double slope = 0.004;
};

/** The shading of a picture that is rendered at `enlarged` times its size. */
EyeDome eyeDomeOf(const SnapshotOptions& options, unsigned enlarged);

/** The largest distance of a pixel's neighbours in rows, rounded up to an even number. */
unsigned reachOf(const EyeDome& shading);

/** Eye-dome lighting (C. Boucheny, 2009): a pixel gets darker by how much nearer those around it
 *  are than it and the opposite ones are farther: steps in depth become dark edges on their far
 *  side, and so do creases; even surfaces stay as they are, and so does what has no depth. The same
 * bytes for any number of threads.
 *  @param logDepth as of toLogDepth(), of the picture's size */
void shadeEyeDome(mrpt::img::CImage& image, const mrpt::math::CMatrixFloat& logDepth,
                  const EyeDome& shading);
}  // namespace delio::picture
