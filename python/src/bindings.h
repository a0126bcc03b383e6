#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/formats/trajectory.h"
#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/step.h"
#include "delio/odometry/wheels.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/options.h"

/** The Python module `delio._delio`. One function for each group of names adds them to the module;
 *  the rest is shared between the groups. */
namespace delio::python {
namespace py = pybind11;

/** Of a matrix: a new float64 array of its shape in C order. */
py::array_t<double> arrayOf(const Eigen::Ref<const Eigen::MatrixXd>& matrix);
/** The pose as a new (4, 4) array. */
py::array_t<double> arrayOf(const Eigen::Isometry3d& pose);
/** The poses as a new (N, 4, 4) array. */
py::array_t<double> arrayOf(const std::vector<Eigen::Isometry3d>& poses);
/** One point per column; as a new (N, 3) array of float32. */
py::array_t<float> pointsArrayOf(const Eigen::Matrix3Xf& points);
/** Of numbers: a new array of one dimension. */
template <class Number>
py::array_t<Number> arrayOf(const std::vector<Number>& numbers) {
    return py::array_t<Number>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

/** The pose in a (4, 4) array. Error, which calls it `name`, for another shape and where it is no
 *  rigid motion. */
Eigen::Isometry3d poseIn(const py::handle& object, const std::string& name);

/** The three numbers of an array of shape (3,) or of a sequence. Error likewise. */
Eigen::Vector3d vectorIn(const py::handle& object, const std::string& name);

/** Fills `cloud` with the points of a float32 or float64 array of shape (N, 3). Error likewise. */
mrpt::maps::CPointsMap::Ptr cloudIn(const py::handle& object, const std::string& name,
                                    mrpt::maps::CPointsMap::Ptr cloud);

/** A number for each of `points` points, of an array of shape (N,); none for None. Error likewise.
 *  Number: float, or std::uint16_t of integers. */
template <class Number>
std::vector<Number> columnIn(const py::object& object, const std::string& name, std::size_t points);

/** A scan, or one made of an array of points and what belongs to it. */
struct ScanArguments {
    py::object points;      //!< a Scan, or float32 or float64 of shape (N, 3)
    py::object stamp;       //!< seconds; None with a Scan
    py::object times;       //!< float32 or float64 of shape (N,), or None
    py::object rings;       //!< integers of shape (N,), or None
    py::object intensity;   //!< numbers of shape (N,), or None
    py::object sensorPose;  //!< (4, 4), or None
};
/** Error for wrong shapes and types, which says what was expected. `index`: of a scan that is made
 *  here. */
Scan scanOf(const ScanArguments& arguments, std::size_t index);

/** Parts of the own vehicle that `object` gives: None, a file, or two corners of a box, metres. */
std::vector<io::VehiclePart> vehicleIn(const py::object& object);

/** Options of a profile, for the drive of `recording` (Scans or None), with `assignments`: words
 *  `section__key` or `section.key` and values. */
Options optionsOf(const std::string& profile, const py::object& recording,
                  const py::dict& assignments);

/** A path, a folder of delio-slam, an (N, 4, 4) array, or a pair of such an array and stamps.
 * Error, which calls it `name`, for everything else. */
io::Trajectory trajectoryOf(const py::handle& object, const std::string& name);

/** An optional path: None is an empty text. */
using OptionalPath = std::optional<std::filesystem::path>;
inline std::string textOf(const OptionalPath& path) { return path ? path->string() : ""; }

/** The scans of a recording, as Python iterates over them. */
struct Scans {
    std::string path;                    //!< of the recording
    std::unique_ptr<io::ScanReader> in;  //!< its reader
    std::mutex mutex;                    //!< for InUse
};

/** Result of an odometry for a scan, as Python sees it. */
struct PythonStep {
    Step step;               //!< without features
    Eigen::Isometry3d pose;  //!< of the vehicle, in its frame at the first scan
    std::size_t points = 0;  //!< of the scan
};

/** Guards an object that one thread uses at a time: Python's lock is released meanwhile. */
class InUse {
 public:
    /** Error where another thread holds `mutex`. */
    explicit InUse(std::mutex& mutex) : lock_(mutex, std::try_to_lock) {
        if (!lock_) throw Error("another thread is using this object; give each thread its own");
    }

 private:
    std::unique_lock<std::mutex> lock_;
};

/** Adds process(points, stamp, ...), which calls Object::process(). `result`: a sentence. */
template <class Object>
void defProcess(py::class_<Object>& to, const std::string& result) {
    const std::string text = result + R"(

points: a Scan, or a float32 or float64 array of shape (N, 3); metres, sensor frame (x forward,
    y left, z up).
stamp: seconds; has to increase from scan to scan. None with a Scan, which has all of its own.
times: float32 or float64 of shape (N,), seconds from the stamp; None: not de-skewed.
rings: integers of shape (N,), or None.
intensity: numbers of shape (N,), or None.
sensor_pose: (4, 4), maps sensor coordinates to vehicle coordinates. None: identity.
Raises delio.Error for wrong shapes and types. Other Python threads run meanwhile.)";
    to.def(
        "process",
        [](Object& self, const py::object& points, const py::object& stamp, const py::object& times,
           const py::object& rings, const py::object& intensity, const py::object& sensorPose) {
            return self.process({points, stamp, times, rings, intensity, sensorPose});
        },
        py::arg("points"), py::arg("stamp") = py::none(), py::arg("times") = py::none(),
        py::arg("rings") = py::none(), py::arg("intensity") = py::none(),
        py::arg("sensor_pose") = py::none(), text.c_str());
}

/** Adds add_imu(sample) and imu_report, which call Object::addImu() and Object::imuReport(). */
template <class Object>
void defImu(py::class_<Object>& to) {
    to.def("add_imu", &Object::addImu, py::arg("sample"),
           R"(Takes an ImuSample of the drive.

Samples up to 0.1 s after a scan's last point have to be added before process() gets the scan, in
any order; later ones wait. The paper's profiles ignore them.)")
        .def_property_readonly(
            "imu_report", &Object::imuReport,
            "ImuReport: what was found out about the IMU so far; None without samples.");
}

/** The same of wheels: add_odometry(sample) and odometry_report. */
template <class Object>
void defOdometry(py::class_<Object>& to) {
    to.def("add_odometry", &Object::addOdometry, py::arg("sample"),
           "Takes an OdometrySample of the drive: a loose prior for the motion along axes that the "
           "scans do not show. As add_imu().")
        .def_property_readonly("odometry_report", &Object::odometryReport,
                               "OdometryReport: what was found out about the wheels so far; None "
                               "without samples.");
}

void bindScans(py::module_& module);         //!< Scan, Scans, open_scans
void bindImu(py::module_& module);           //!< ImuSample, ImuReport
void bindWheels(py::module_& module);        //!< OdometrySample, OdometryReport
void bindSteps(py::module_& module);         //!< Step
void bindOdometry(py::module_& module);      //!< Odometry
void bindSlam(py::module_& module);          //!< Slam
void bindPlaces(py::module_& module);        //!< StoredMap, Localiser, Localisation
void bindTrajectories(py::module_& module);  //!< read_trajectory, write_trajectory
void bindEvaluation(py::module_& module);    //!< evaluate, Metrics
void bindAlign(py::module_& module);         //!< align, Alignment
void bindRun(py::module_& module);           //!< run, RunResult
}  // namespace delio::python
