#include "delio/odometry/wheels.h"
#include "bindings.h"

namespace delio::python {
void bindWheels(py::module_& module) {
    py::class_<OdometrySample>(module, "OdometrySample", R"(A pose by wheels or another odometry.

stamp: seconds, of the clock of the scans' stamps.
pose: (4, 4); maps the odometry's moving frame to its fixed one, which may drift.
sensor_pose: (4, 4); maps the moving frame's coordinates to the vehicle's. None: it is the vehicle's.
Raises delio.Error for a wrong shape or type.)")
        .def(py::init([](double stamp, const py::object& pose, const py::object& sensorPose) {
                 OdometrySample sample;
                 sample.stamp_s = stamp;
                 sample.pose = poseIn(pose, "pose");
                 if (!sensorPose.is_none()) sample.sensorPose = poseIn(sensorPose, "sensor_pose");
                 return sample;
             }),
             py::arg("stamp"), py::arg("pose"), py::arg("sensor_pose") = py::none())
        .def_readonly("stamp", &OdometrySample::stamp_s, "Seconds.")
        .def_property_readonly(
            "pose", [](const OdometrySample& of) { return arrayOf(of.pose); },
            "(4, 4): maps the odometry's moving frame to its fixed one.")
        .def_property_readonly(
            "sensor_pose",
            [](const OdometrySample& of) -> py::object {
                return of.sensorPose ? py::object(arrayOf(*of.sensorPose)) : py::none();
            },
            "(4, 4): maps the moving frame's coordinates to the vehicle's; None: it is that.");
    py::class_<OdometryReport>(module, "OdometryReport",
                               "What a LiDAR odometry found out about the wheels.")
        .def_readonly("samples", &OdometryReport::samples, "Number of samples that were used.")
        .def_readonly("dropped", &OdometryReport::dropped,
                      "Number of samples that were not finite or came twice.")
        .def_readonly("jumps", &OdometryReport::jumps,
                      "Number of intervals faster than a vehicle moves.")
        .def_readonly("scans", &OdometryReport::scans, "Number of scans after the first sample.")
        .def_readonly("scans_without_samples", &OdometryReport::scansWithout,
                      "Number of scans for which samples were missing.")
        .def_readonly("scans_carried", &OdometryReport::scansCarried,
                      "Number of scans whose motion along an unobserved axis is the wheels'.")
        .def_readonly("compared", &OdometryReport::compared,
                      "Number of stretches of 2 m or more that were compared to the scans.")
        .def_readonly("contradicting", &OdometryReport::contradicting,
                      "Number of these on which the wheels differ from the scans.")
        .def_readonly("scale", &OdometryReport::scale,
                      "The wheels' distances times this are those of the scans.")
        .def_readonly("sigma", &OdometryReport::sigma,
                      "Standard deviation of the scaled distances, as a part of the way; None: not "
                      "known.")
        .def_readonly("findings", &OdometryReport::findings,
                      "list of str: why the wheels were not or not always used.");
}
}  // namespace delio::python
