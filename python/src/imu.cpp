#include "delio/odometry/imu.h"
#include "bindings.h"

namespace delio::python {
namespace {
py::object arrayOrNone(const Eigen::Vector3d& vector) {
    return vector.allFinite() ? py::object(arrayOf(Eigen::MatrixXd(vector)).attr("ravel")())
                              : py::object(py::none());
}

void bindSample(py::module_& module) {
    py::class_<ImuSample>(module, "ImuSample", R"(One measurement of an IMU.

stamp: seconds, of the clock of the scans' stamps.
rate: (3,), angular velocity in rad/s, in the IMU's frame.
acceleration: (3,), m/s^2, in the IMU's frame (at rest 9.81 upwards), or None. Not used yet.
sensor_pose: (4, 4); maps the IMU's coordinates to the vehicle's. None: calibrated from the motion.
Raises delio.Error for a wrong shape or type.)")
        .def(py::init([](double stamp, const py::object& rate, const py::object& acceleration,
                         const py::object& sensorPose) {
                 ImuSample sample;
                 sample.stamp_s = stamp;
                 sample.rate_radps = vectorIn(rate, "rate");
                 if (!acceleration.is_none())
                     sample.acceleration_mps2 = vectorIn(acceleration, "acceleration");
                 if (!sensorPose.is_none()) sample.sensorPose = poseIn(sensorPose, "sensor_pose");
                 return sample;
             }),
             py::arg("stamp"), py::arg("rate"), py::arg("acceleration") = py::none(),
             py::arg("sensor_pose") = py::none())
        .def_readonly("stamp", &ImuSample::stamp_s, "Seconds.")
        .def_property_readonly(
            "rate", [](const ImuSample& of) { return arrayOrNone(of.rate_radps); },
            "(3,): rad/s, in the IMU's frame; None where it was not measured.")
        .def_property_readonly(
            "acceleration", [](const ImuSample& of) { return arrayOrNone(of.acceleration_mps2); },
            "(3,): m/s^2, in the IMU's frame; None where it was not measured.")
        .def_property_readonly(
            "sensor_pose",
            [](const ImuSample& of) -> py::object {
                return of.sensorPose ? py::object(arrayOf(*of.sensorPose)) : py::none();
            },
            "(4, 4): maps the IMU's coordinates to the vehicle's; None where it is not known.");
}

void bindReport(py::module_& module) {
    py::class_<ImuReport>(module, "ImuReport", "What an odometry found out about the IMU.")
        .def_readonly("samples", &ImuReport::samples, "Number of samples that were used.")
        .def_readonly("dropped", &ImuReport::dropped,
                      "Number of samples that were not finite, had no rate, or came twice.")
        .def_readonly("scans", &ImuReport::scans, "Number of scans after the first sample.")
        .def_readonly("scans_used", &ImuReport::scansUsed,
                      "Number of scans whose rotation the gyroscope predicted.")
        .def_readonly("scans_without_samples", &ImuReport::scansWithout,
                      "Number of scans for which samples were missing.")
        .def_property_readonly(
            "rotation",
            [](const ImuReport& of) -> py::object {
                return of.rotation ? py::object(arrayOf(Eigen::MatrixXd(*of.rotation)))
                                   : py::none();
            },
            "(3, 3): maps the IMU's axes to the LiDAR's; None where the IMU is not used.")
        .def_readonly("rotation_sigma", &ImuReport::rotationSigma_rad,
                      "rad; standard deviation of the calibrated rotation; None: not calibrated.")
        .def_readonly("offset", &ImuReport::offset_s,
                      "s; added to a scan's time, it gives the IMU's stamp.")
        .def_readonly("offset_sigma", &ImuReport::offsetSigma_s,
                      "s; its standard deviation; None: the offset is not known.")
        .def_property_readonly(
            "bias", [](const ImuReport& of) { return arrayOrNone(of.bias_radps); },
            "(3,): rad/s, of the angular velocity, in the IMU's frame.")
        .def_readonly("residual", &ImuReport::residual_rad,
                      "rad; root mean square of the difference to the scans' rotations.")
        .def_readonly("findings", &ImuReport::findings,
                      "list of str: why the gyroscope was not or not always used.");
}
}  // namespace

void bindImu(py::module_& module) {
    bindSample(module);
    bindReport(module);
}
}  // namespace delio::python
