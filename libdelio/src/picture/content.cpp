#include "content.h"

#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>

#include <cmath>

#include "delio/core/geometry.h"
#include "marks.h"

namespace delio::picture {
using Eigen::Isometry3d;
using Eigen::Vector3d;
using mrpt::opengl::CRenderizable;

namespace {
constexpr std::size_t kMaxSamples = 200000;

/** Where an object's own point lies in the scene; left out if that is nowhere. */
void add(const mrpt::math::TPoint3D& point, const Isometry3d& pose, std::vector<Vector3d>& to) {
    const Vector3d at = pose * Vector3d(point.x, point.y, point.z);
    if (at.allFinite()) to.push_back(at);
}

template <typename Cloud>
void sample(const Cloud& cloud, const Isometry3d& pose, Content& content) {
    content.cloudSize += cloud.size();
    const std::size_t step = cloud.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < cloud.size(); i += step)
        add(mrpt::math::TPoint3D(cloud.getPoint3Df(i)), pose, content.points);
}

void sampleLines(const mrpt::opengl::CSetOfLines& lines, const Isometry3d& pose,
                 std::vector<Vector3d>& to) {
    const std::size_t step = lines.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < lines.size(); i += step) {
        const auto& line = lines.begin()[static_cast<std::ptrdiff_t>(i)];
        add(line.point1, pose, to);
        add(line.point2, pose, to);
    }
}

/** Corners of the box around an object: for what is neither points nor lines. */
void addBox(const CRenderizable& object, const Isometry3d& pose, std::vector<Vector3d>& to) {
    const auto box = object.getBoundingBoxLocal();
    for (int corner = 0; corner < 8; ++corner)
        add({corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
             corner & 4 ? box.max.z : box.min.z},
            pose, to);
}

void collect(const CRenderizable::Ptr& object, const Isometry3d& parent, Content& content) {
    const Isometry3d pose = parent * fromMrpt(mrpt::poses::CPose3D(object->getPose()));
    if (!object->isVisible() || object->getName() == kRemovedName) return;
    if (const auto set = std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(object)) {
        for (const auto& child : *set) collect(child, pose, content);
    } else if (const auto coloured =
                   std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object)) {
        sample(*coloured, pose, content);
    } else if (const auto plain = std::dynamic_pointer_cast<mrpt::opengl::CPointCloud>(object)) {
        sample(*plain, pose, content);
    } else if (const auto lines = std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object)) {
        sampleLines(*lines, pose, content.lines);
    } else if (std::dynamic_pointer_cast<mrpt::opengl::CGridPlaneXY>(object)) {
        addBox(*object, pose, content.grids);
    } else if (!std::dynamic_pointer_cast<mrpt::opengl::CCamera>(object)) {
        addBox(*object, pose, content.lines);
    }
}
}  // namespace

Content contentOf(const mrpt::opengl::COpenGLScene& scene) {
    Content content;
    for (const auto& object : *scene.getViewport())
        collect(object, Isometry3d::Identity(), content);
    return content;
}
}  // namespace delio::picture
