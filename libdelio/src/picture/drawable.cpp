#include "drawable.h"

#include <mrpt/opengl/CArrow.h>
#include <mrpt/opengl/CAxis.h>
#include <mrpt/opengl/CCylinder.h>
#include <mrpt/opengl/CDisk.h>
#include <mrpt/opengl/CEllipsoid2D.h>
#include <mrpt/opengl/CEllipsoid3D.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/CGridPlaneXZ.h>
#include <mrpt/opengl/CSphere.h>

#include <algorithm>
#include <cmath>

#include "delio/core/error.h"

namespace delio::picture {
namespace {
using mrpt::opengl::CRenderizable;

/** Lines from `low` to `high`, one every `step`; MRPT adds the step in single precision, which far
 *  from 0 may come to nothing. */
void checkLines(float low, float high, float step, float most) {
    constexpr float kFarthest = 1e6F;  // steps
    const bool ends = step > 0 && std::isfinite(step) && (high - low) / step <= most &&
                      std::abs(low) / step < kFarthest && std::abs(high) / step < kFarthest;
    if (!ends) throw Error("has a grid or axis of more lines than can be drawn");
}

template <typename Grid>
void checkGrid(const Grid& grid) {
    float low1 = 0, high1 = 0, low2 = 0, high2 = 0;
    grid.getPlaneLimits(low1, high1, low2, high2);
    constexpr float kMost = 20'000;
    checkLines(low1, high1, grid.getGridFrequency(), kMost);
    checkLines(low2, high2, grid.getGridFrequency(), kMost);
}

void checkAxis(const mrpt::opengl::CAxis& axis) {
    const auto box = axis.getBoundingBoxLocal();
    constexpr float kMost = 2000;  // each with a text
    for (int k = 0; k < 3; ++k)
        checkLines(static_cast<float>(box.min[k]), static_cast<float>(box.max[k]),
                   axis.getFrequency(), kMost);
}

template <typename Shape>
std::shared_ptr<Shape> as(const CRenderizable::Ptr& object) {
    return std::dynamic_pointer_cast<Shape>(object);
}

void round(const CRenderizable::Ptr& object) {
    constexpr unsigned kUsual = 30, kMost = 1000;
    if (const auto cylinder = as<mrpt::opengl::CCylinder>(object))
        cylinder->setSlicesCount(std::min(cylinder->getSlicesCount(), kMost));
    else if (const auto arrow = as<mrpt::opengl::CArrow>(object))
        arrow->setSlicesCount(std::min(arrow->getSlicesCount(), kMost));
    else if (const auto disk = as<mrpt::opengl::CDisk>(object))
        disk->setSlicesCount(kUsual);
    else if (const auto flat = as<mrpt::opengl::CEllipsoid2D>(object))
        flat->set2DsegmentsCount(kUsual);
    else if (const auto sphere = as<mrpt::opengl::CSphere>(object)) {
        sphere->setNumberDivsLongitude(kUsual);
        sphere->setNumberDivsLatitude(kUsual);
    } else if (const auto ellipsoid = as<mrpt::opengl::CEllipsoid3D>(object))
        ellipsoid->set3DsegmentsCount(kUsual);
}
}  // namespace

void makeDrawable(mrpt::opengl::COpenGLScene& scene) {
    if (!scene.getViewport()) throw Error("has no main view");
    scene.visitAllObjects([](const CRenderizable::Ptr& object) {
        if (const auto grid = as<mrpt::opengl::CGridPlaneXY>(object)) checkGrid(*grid);
        if (const auto grid = as<mrpt::opengl::CGridPlaneXZ>(object)) checkGrid(*grid);
        if (const auto axis = as<mrpt::opengl::CAxis>(object)) checkAxis(*axis);
        round(object);
    });
}
}  // namespace delio::picture
