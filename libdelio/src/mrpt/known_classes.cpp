#include "object_archive.h"

#include <algorithm>
#include <array>

namespace delio::io {
namespace {
using namespace std::string_view_literals;

/** In what a sensor saw, and where it was. Of the observations all but scenes. */
constexpr std::array kOfScans = {
    "mrpt::maps::CColouredPointsMap"sv,
    "mrpt::maps::CPointsMapXYZI"sv,
    "mrpt::maps::CSimplePointsMap"sv,
    "mrpt::maps::CWeightedPointsMap"sv,
    "mrpt::maps::TMapGenericParams"sv,
    "mrpt::math::CMatrixB"sv,
    "mrpt::math::CMatrixD"sv,
    "mrpt::math::CMatrixF"sv,
    "mrpt::img::CImage"sv,
    "mrpt::img::TCamera"sv,
    "mrpt::img::TStereoCamera"sv,
    "mrpt::obs::CActionCollection"sv,
    "mrpt::obs::CActionRobotMovement2D"sv,
    "mrpt::obs::CActionRobotMovement3D"sv,
    "mrpt::obs::CSensoryFrame"sv,
    "mrpt::poses::CPoint2D"sv,
    "mrpt::poses::CPoint3D"sv,
    "mrpt::poses::CPointPDFGaussian"sv,
    "mrpt::poses::CPose2D"sv,
    "mrpt::poses::CPose3D"sv,
    "mrpt::poses::CPose3DPDFGaussian"sv,
    "mrpt::poses::CPose3DPDFGaussianInf"sv,
    "mrpt::poses::CPose3DPDFParticles"sv,
    "mrpt::poses::CPose3DPDFSOG"sv,
    "mrpt::poses::CPose3DQuat"sv,
    "mrpt::poses::CPose3DQuatPDFGaussian"sv,
    "mrpt::poses::CPose3DQuatPDFGaussianInf"sv,
    "mrpt::poses::CPosePDFGaussian"sv,
    "mrpt::poses::CPosePDFGaussianInf"sv,
    "mrpt::poses::CPosePDFParticles"sv,
    "mrpt::poses::CPosePDFSOG"sv,
};

/** Shapes that hold what they show; not models that are read from other files. */
constexpr std::array kOfScenes = {
    "mrpt::img::CImage"sv,
    "mrpt::img::TCamera"sv,
    "mrpt::math::CMatrixB"sv,
    "mrpt::math::CMatrixD"sv,
    "mrpt::math::CMatrixF"sv,
    "mrpt::obs::CObservation2DRangeScan"sv,  // in a CPlanarLaserScan
    "mrpt::opengl::CArrow"sv,
    "mrpt::opengl::CAxis"sv,
    "mrpt::opengl::CBox"sv,
    "mrpt::opengl::CCamera"sv,
    "mrpt::opengl::CColorBar"sv,
    "mrpt::opengl::CCylinder"sv,
    "mrpt::opengl::CDisk"sv,
    "mrpt::opengl::CEllipsoid2D"sv,
    "mrpt::opengl::CEllipsoid3D"sv,
    "mrpt::opengl::CFrustum"sv,
    "mrpt::opengl::CGridPlaneXY"sv,
    "mrpt::opengl::CGridPlaneXZ"sv,
    "mrpt::opengl::COctoMapVoxels"sv,
    "mrpt::opengl::COpenGLScene"sv,
    "mrpt::opengl::COpenGLViewport"sv,
    "mrpt::opengl::CPlanarLaserScan"sv,
    "mrpt::opengl::CPointCloud"sv,
    "mrpt::opengl::CPointCloudColoured"sv,
    "mrpt::opengl::CSetOfLines"sv,
    "mrpt::opengl::CSetOfObjects"sv,
    "mrpt::opengl::CSetOfTriangles"sv,
    "mrpt::opengl::CSimpleLine"sv,
    "mrpt::opengl::CSphere"sv,
    "mrpt::opengl::CText"sv,
    "mrpt::opengl::CText3D"sv,
    "mrpt::opengl::CTexturedPlane"sv,
    "mrpt::opengl::CSetOfTexturedTriangles"sv,
    "mrpt::poses::CPose3D"sv,
};

template <typename Names>
bool holds(const Names& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool isObservation(std::string_view name) {
    constexpr std::string_view kBegin = "mrpt::obs::CObservation";
    return name.size() > kBegin.size() && name.substr(0, kBegin.size()) == kBegin &&
           name != "mrpt::obs::CObservation3DScene";
}
}  // namespace

bool isKnown(std::string_view className, FileOf file) {
    if (file == FileOf::Scene) return holds(kOfScenes, className);
    if (file == FileOf::Keyframes && className == "mrpt::maps::CSimpleMap") return true;
    return isObservation(className) || holds(kOfScans, className);
}
}  // namespace delio::io
