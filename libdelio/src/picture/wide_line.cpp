#include "wide_line.h"

#include <algorithm>

namespace delio::picture {
mrpt::opengl::CSetOfLines::Ptr wideLines(const mrpt::img::TColor& colour, float width_px) {
    auto set = mrpt::opengl::CSetOfLines::Create();
    set->setColor_u8(colour);
    set->setVerticesPointSize(width_px);
    set->enableVariablePointSize(false);
    return set;
}

void appendWide(mrpt::opengl::CSetOfLines& set, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, double piece_m) {
    const int pieces = std::clamp(static_cast<int>((to - from).norm() / piece_m), 1, 1000);
    const auto at = [&](int k) {
        const Eigen::Vector3d p = from + (to - from) * (double(k) / pieces);
        return mrpt::math::TPoint3D(p.x(), p.y(), p.z());
    };
    for (int k = 0; k < pieces; ++k) set.appendLine(at(k), at(k + 1));
}
}  // namespace delio::picture
