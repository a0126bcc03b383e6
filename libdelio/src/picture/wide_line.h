#pragma once
#include <mrpt/img/TColor.h>
#include <mrpt/opengl/CSetOfLines.h>

#include <Eigen/Core>

namespace delio::picture {
/** A set for appendWide(). MRPT draws every line one pixel wide, but the ends of its pieces as dots
 *  of any size: of short pieces a line looks as wide as that. */
mrpt::opengl::CSetOfLines::Ptr wideLines(const mrpt::img::TColor& colour, float width_px);

/** Appends a line in up to 1000 pieces of about `piece_m`. */
void appendWide(mrpt::opengl::CSetOfLines& set, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, double piece_m);
}  // namespace delio::picture
