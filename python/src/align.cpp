#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <cmath>
#include <sstream>

#include "bindings.h"
#include "delio/core/geometry.h"
#include "delio/odometry/aligner.h"

namespace delio::python {
namespace {
/** Result of align(). */
struct Alignment {
    Increment increment;
    Aligner::TReturnInfo info;
};

/** Covariance of x y z yaw pitch roll as that of the right tangent of `pose`. */
Matrix6 inTangent(const Matrix6& covariance, const mrpt::poses::CPose3D& pose) {
    const double p = pose.pitch(), r = pose.roll();
    Matrix6 J = Matrix6::Zero();
    J.topLeftCorner<3, 3>() = fromMrpt(pose).linear().transpose();
    // Angular velocity in the later frame by the rates of yaw, pitch and roll.
    J.bottomRightCorner<3, 3>() << -std::sin(p), 0, 1,  //
        std::cos(p) * std::sin(r), std::cos(r), 0,      //
        std::cos(p) * std::cos(r), -std::sin(r), 0;
    return J * covariance * J.transpose();
}

Alignment align(const py::object& first, const py::object& second, const py::object& guess) {
    const auto a = cloudIn(first, "first", mrpt::maps::CSimplePointsMap::Create());
    const auto b = cloudIn(second, "second", mrpt::maps::CSimplePointsMap::Create());
    const auto start = guess.is_none() ? Eigen::Isometry3d::Identity() : poseIn(guess, "guess");
    const py::gil_scoped_release release;
    Alignment found;
    Aligner aligner;
    const auto pdf = aligner.Align3DPDF(a.get(), b.get(),
                                        mrpt::poses::CPose3DPDFGaussian(toMrpt(start)), found.info);
    mrpt::math::CMatrixDouble66 covariance;
    mrpt::poses::CPose3D pose;
    pdf->getCovarianceAndMean(covariance, pose);
    found.increment = {fromMrpt(pose), inTangent(covariance.asEigen(), pose)};
    return found;
}
}  // namespace

void bindAlign(py::module_& module) {
    py::class_<Alignment>(module, "Alignment", "Result of align().")
        .def_property_readonly(
            "pose", [](const Alignment& of) { return arrayOf(of.increment.pose); },
            "(4, 4): maps coordinates of the second cloud to those of the first; metres.")
        .def_property_readonly(
            "covariance",
            [](const Alignment& of) { return arrayOf(Eigen::MatrixXd(of.increment.covariance)); },
            "(6, 6): of the pose, [x y z wx wy wz], metres and radians, in the second's frame.")
        .def_property_readonly(
            "inlier_ratio", [](const Alignment& of) { return of.info.goodness; },
            "Fraction of the second cloud's points that lie on planes of the first.")
        .def_property_readonly(
            "agreement", [](const Alignment& of) { return of.info.agreement; },
            "Fraction of its surfaces that are surfaces of the first, too, 0 to 1.")
        .def_property_readonly(
            "residual", [](const Alignment& of) { return of.info.residual_m; },
            "m; root mean square distance of the matched points from their planes.")
        .def_property_readonly(
            "searched", [](const Alignment& of) { return of.info.searched; },
            "The guess was too far off: the motion was searched.");
    module.def("align", &align, py::arg("first"), py::arg("second"), py::arg("guess") = py::none(),
               R"(Registers two clouds of surfaces; returns an Alignment.

first, second: float32 or float64 of shape (N, 3), metres.
guess: (4, 4), second to first; None: identity. Where it is too far off, the motion is searched
    within 10 m horizontally.
Raises delio.Error where a cloud has no planes or too few points.)");
}
}  // namespace delio::python
