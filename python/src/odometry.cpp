#include <algorithm>
#include <utility>

#include "bindings.h"
#include "delio/core/geometry.h"
#include "delio/odometry/odometry.h"
#include "delio/run/doubts.h"
#include "delio/slam/slam.h"

namespace delio::python {
namespace {
/** As options have it: true, 0.25, a word. */
std::string textOf(const py::handle& value) {
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    return py::str(value).cast<std::string>();
}
}  // namespace

Options optionsOf(const std::string& profile, const py::object& recording,
                  const py::dict& assignments) {
    if (!recording.is_none() && !py::isinstance<Scans>(recording))
        throw Error("'recording' must be what delio.open_scans() returns, or None");
    Options options = Options::forDrive(
        profile, recording.is_none() ? std::nullopt : recording.cast<const Scans&>().in->meta());
    for (const auto& [key, value] : assignments) {
        auto name = key.cast<std::string>();
        if (const auto at = name.find("__"); at != std::string::npos) name.replace(at, 2, ".");
        options.set(name + "=" + textOf(value));
    }
    options.check();
    return options;
}

namespace {
const char* stateOf(const PythonStep& of) {
    run::RunRow row;
    row.lost = of.step.lost;
    row.predicted = of.step.predicted;
    row.quality = of.step.quality;
    return run::stateOf(row);
}

/** True for each point of the scan on a dynamic object. */
py::array_t<bool> dynamicOf(const PythonStep& of) {
    const auto& used = of.step.used;
    py::array_t<bool> mask(static_cast<py::ssize_t>(of.points));
    bool* to = mask.mutable_data();
    std::fill_n(to, of.points, false);
    for (std::size_t i = 0; i < used.dynamic.size(); ++i)
        if (used.dynamic[i] != 0) to[used.indices[i]] = true;
    return mask;
}

py::dict dictOf(const std::vector<Named>& named) {
    py::dict dict;
    for (const auto& [name, value] : named) dict[py::str(name)] = value;
    return dict;
}

using StepClass = py::class_<PythonStep>;

void bindPoses(StepClass& step) {
    step.def_property_readonly(
            "pose", [](const PythonStep& of) { return arrayOf(of.pose); },
            "(4, 4): maps the vehicle's coordinates to those at the first scan; metres. The "
            "vehicle "
            "is the sensor where no sensor_pose was given.")
        .def_property_readonly(
            "increment", [](const PythonStep& of) { return arrayOf(of.step.increment.pose); },
            "(4, 4): maps the sensor's coordinates to those at the scan before; identity for the "
            "first scan.")
        .def_property_readonly(
            "corrected",
            [](const PythonStep& of) {
                py::list poses;
                for (const auto& corrected : of.step.corrected)
                    poses.append(py::make_tuple(corrected.scansAgo, arrayOf(corrected.pose)));
                return poses;
            },
            "list of (scans_ago, (4, 4)): earlier scans whose poses at their stamps are now known "
            "better; "
            "each pose maps the sensor's coordinates at that scan to those at this one.")
        .def_property_readonly(
            "covariance",
            [](const PythonStep& of) {
                return arrayOf(Eigen::MatrixXd(of.step.increment.covariance));
            },
            "(6, 6): covariance of the increment, [x y z wx wy wz], metres and radians, in the "
            "sensor's frame at this scan (the right tangent).")
        .def_property_readonly(
            "unobserved_translation",
            [](const PythonStep& of) {
                return arrayOf(Eigen::MatrixXd(of.step.quality.unobservedTranslation.transpose()));
            },
            "(K, 3): unit vectors in the sensor's frame along which the prediction was kept.")
        .def_property_readonly(
            "unobserved_rotation",
            [](const PythonStep& of) {
                return arrayOf(Eigen::MatrixXd(of.step.quality.unobservedRotation.transpose()));
            },
            "(K, 3): unit vectors in the sensor's frame about which the prediction was kept.");
}

void bindPoints(StepClass& step) {
    step.def_property_readonly(
            "dynamic", &dynamicOf,
            "bool of shape (N,): True for each point of the scan on a dynamic object.")
        .def_property_readonly(
            "points", [](const PythonStep& of) { return pointsArrayOf(of.step.used.points); },
            "float32 of shape (M, 3): the points that were used, de-skewed to the stamp; metres, "
            "sensor frame.")
        .def_property_readonly(
            "indices", [](const PythonStep& of) { return arrayOf(of.step.used.indices); },
            "uint32 of shape (M,): index in the scan of each of `points`.")
        .def_property_readonly(
            "not_finite", [](const PythonStep& of) { return of.step.notFinite; },
            "Number of points that were dropped: a coordinate was NaN or infinite.");
}
}  // namespace

void bindSteps(py::module_& module) {
    StepClass step(module, "Step", "Result of an odometry for one scan. Arrays are new copies.");
    bindPoses(step);
    bindPoints(step);
    step.def_property_readonly("state", &stateOf,
                               "'tracked', 'weak' (an axis was not observed), 'predicted' (not "
                               "registered) or 'lost'; as in scans.csv.")
        .def_property_readonly(
            "reason", [](const PythonStep& of) { return of.step.reason; },
            "Why the scan was not registered; empty where it was.")
        .def_property_readonly(
            "predicted", [](const PythonStep& of) { return of.step.predicted; },
            "The scan could not be registered: the increment is the prediction.")
        .def_property_readonly(
            "lost", [](const PythonStep& of) { return of.step.lost; },
            "Where the sensor went since it was tracked last is not known.")
        .def_property_readonly(
            "searched", [](const PythonStep& of) { return of.step.searched; },
            "The motion was searched over a wide range.")
        .def_property_readonly(
            "track", [](const PythonStep& of) { return of.step.track; },
            "Number of the track. A new track begins with a new map, after scans that were not "
            "found in the one before.")
        .def_property_readonly(
            "interrupted", [](const PythonStep& of) { return of.step.interrupted; },
            "The scan came after a time gap or clock jump.")
        .def_property_readonly(
            "standing", [](const PythonStep& of) { return of.step.standing; },
            "The sensor stood still: below 0.1 m/s and 2 deg/s.")
        .def_property_readonly(
            "deskewed", [](const PythonStep& of) { return of.step.deskewed; },
            "The points had times.")
        .def_property_readonly(
            "matches", [](const PythonStep& of) { return of.step.quality.matches; },
            "Number of correspondences.")
        .def_property_readonly(
            "residual", [](const PythonStep& of) { return of.step.quality.residual_m; },
            "m; root mean square of their distances.")
        .def_property_readonly(
            "times_ms", [](const PythonStep& of) { return dictOf(of.step.times_ms); },
            "dict: name of each stage to its time in milliseconds.")
        .def_property_readonly(
            "details", [](const PythonStep& of) { return dictOf(of.step.details); },
            "dict: the method's own figures, as in scans.csv.");
}

namespace {
/** An odometry and the pose of its vehicle. */
class PythonOdometry {
 public:
    explicit PythonOdometry(const Options& options) : slam_(makeOdometry(options), History::Last) {}

    PythonStep process(const ScanArguments& arguments) {
        const Scan scan = scanOf(arguments, scans_);
        const py::gil_scoped_release release;
        const InUse inUse(mutex_);
        auto report = slam_.process(scan);
        ++scans_;
        report.step.features.reset();
        return {std::move(report.step), slam_.trajectory().poses.back(), scan.points->size()};
    }

    void addImu(const ImuSample& sample) {
        const InUse inUse(mutex_);
        slam_.addImu(sample);
    }

    std::optional<ImuReport> imuReport() {
        const InUse inUse(mutex_);
        return slam_.imuReport();
    }

    void addOdometry(const OdometrySample& sample) {
        const InUse inUse(mutex_);
        slam_.addOdometry(sample);
    }

    std::optional<OdometryReport> odometryReport() {
        const InUse inUse(mutex_);
        return slam_.odometryReport();
    }

 private:
    Slam slam_;
    std::size_t scans_ = 0;
    std::mutex mutex_;
};
}  // namespace

void bindOdometry(py::module_& module) {
    py::class_<PythonOdometry> odometry(module, "Odometry",
                                        R"(LiDAR odometry: one scan after the other.

profile: 'accurate', 'paper', 'paper-extended' or 'paper-literal'.
recording: what open_scans() returned, for its vertical correction and de-skewing; None for your own
    sensor.
options: section__key=value, as `delio-slam --set section.key=value`.
Raises delio.Error for an unknown profile or option. Memory does not grow with the number of scans.)");
    odometry.def(
        py::init(
            [](const std::string& profile, const py::object& recording, const py::kwargs& options) {
                return std::make_unique<PythonOdometry>(optionsOf(profile, recording, options));
            }),
        py::arg("profile") = "accurate", py::kw_only(), py::arg("recording") = py::none());
    defProcess(odometry, "Registers the next scan and returns its Step.");
    defImu(odometry);
    defOdometry(odometry);
}
}  // namespace delio::python
