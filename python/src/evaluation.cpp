#include <cmath>
#include <tuple>

#include "bindings.h"
#include "delio/core/geometry.h"
#include "delio/evaluation/comparison.h"
#include "delio/run/run_folder.h"

namespace delio::python {
namespace fs = std::filesystem;
using evaluation::Comparison;
using run::RunFolder;

namespace {
std::vector<Eigen::Isometry3d> posesIn(const py::handle& object, const std::string& name) {
    const auto array = py::array::ensure(object);
    if (!array) PyErr_Clear();
    if (!array || array.ndim() != 3 || array.shape(1) != 4 || array.shape(2) != 4)
        throw Error("'" + name +
                    "' must be a path, poses of shape (N, 4, 4), or a pair of poses "
                    "and stamps");
    std::vector<Eigen::Isometry3d> poses;
    for (py::ssize_t i = 0; i < array.shape(0); ++i)
        poses.push_back(poseIn(array[py::int_(i)], name));
    return poses;
}

/** The pose file of a folder that delio-slam has written. */
std::string fileIn(const std::string& path) {
    if (!fs::is_directory(path)) return path;
    const RunFolder folder(path);
    if (!folder.has(RunFolder::kTrajectory))
        throw Error("'" + path + "' is a folder without " + RunFolder::kTrajectory);
    return folder.path(folder.has(RunFolder::kCam0) ? RunFolder::kCam0 : RunFolder::kTrajectory);
}

bool isPath(const py::handle& object) {
    return py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__");
}
}  // namespace

io::Trajectory trajectoryOf(const py::handle& object, const std::string& name) {
    if (isPath(object)) return io::readTrajectory(fileIn(object.cast<fs::path>().string()));
    if (!py::isinstance<py::tuple>(object)) return {posesIn(object, name), {}};
    const auto pair = py::reinterpret_borrow<py::tuple>(object);
    if (pair.size() != 2) throw Error("'" + name + "' must be a pair of poses and stamps");
    io::Trajectory trajectory{posesIn(pair[0], name), {}};
    const auto stamps =
        py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(pair[1]);
    if (!stamps) PyErr_Clear();
    if (!stamps || stamps.ndim() != 1 ||
        stamps.shape(0) != static_cast<py::ssize_t>(trajectory.poses.size()))
        throw Error("'" + name + "' must have stamps of shape (" +
                    std::to_string(trajectory.poses.size()) + ",), one for each pose");
    trajectory.stamps_s.assign(stamps.data(), stamps.data() + stamps.size());
    for (std::size_t i = 1; i < trajectory.stamps_s.size(); ++i)
        if (!(trajectory.stamps_s[i] > trajectory.stamps_s[i - 1]))
            throw Error("'" + name + "' must have stamps that increase; stamp " +
                        std::to_string(i) + " does not");
    return trajectory;
}

void bindTrajectories(py::module_& module) {
    module.def(
        "read_trajectory",
        [](const fs::path& path) -> py::tuple {
            const auto trajectory = io::readTrajectory(fileIn(path.string()));
            py::object stamps = py::none();
            if (!trajectory.stamps_s.empty()) stamps = arrayOf(trajectory.stamps_s);
            return py::make_tuple(arrayOf(trajectory.poses), stamps);
        },
        py::arg("path"),
        "Reads a pose file in KITTI's or TUM's format, or of a folder of delio-slam. Returns poses "
        "(N, 4, 4), metres, and stamps (N,), seconds, or None where the file has none.");
    module.def(
        "write_trajectory",
        [](const fs::path& path, const py::object& poses, const py::object& stamps) {
            if (stamps.is_none())
                return io::writeKitti(trajectoryOf(poses, "poses"), path.string());
            io::writeTum(trajectoryOf(py::make_tuple(poses, stamps), "poses"), path.string());
        },
        py::arg("path"), py::arg("poses"), py::arg("stamps") = py::none(),
        "Writes poses (N, 4, 4), metres, in KITTI's format, or with stamps (N,), seconds, in "
        "TUM's. "
        "The same poses give the same bytes as delio-slam writes.");
}

namespace {
/** The scans that the poses of delio-slam are of. */
std::optional<io::ScanTable> scansBeside(const py::object& estimate, std::size_t poses) {
    if (!isPath(estimate)) return {};
    const fs::path file = fileIn(estimate.cast<fs::path>().string());
    const fs::path table = file.parent_path() / RunFolder::kScans;
    if (file.filename().string().rfind("trajectory", 0) != 0 || !fs::exists(table)) return {};
    auto scans = io::readScanTable(table.string());
    if (scans.scans.size() != poses) return {};
    return scans;
}

Comparison compared(const py::object& reference, const py::object& estimate,
                    const std::vector<double>& lengths, std::size_t delta,
                    const py::object& calibration) {
    if (delta == 0) throw Error("'delta' must be a number of poses, at least 1");
    auto poses = trajectoryOf(estimate, "estimate");
    const auto scans = scansBeside(estimate, poses.poses.size());
    if (!calibration.is_none()) poses = io::lidarToCam0(poses, poseIn(calibration, "calibration"));
    return evaluation::compare(trajectoryOf(reference, "reference"), poses, {lengths, delta},
                               scans ? &*scans : nullptr);
}

py::dict perLengthOf(const Comparison& of) {
    py::dict dict;
    for (const auto& length : of.row.kitti.perLength)
        dict[py::float_(length.length_m)] = py::make_tuple(length.t_percent, length.r_deg_per_100m);
    return dict;
}

std::vector<std::string> warningsOf(const Comparison& of) {
    std::vector<std::string> lines;
    if (of.unmatchedReference + of.unmatchedEstimate > 0)
        lines.push_back(std::to_string(of.unmatchedEstimate) + " poses of the estimate and " +
                        std::to_string(of.unmatchedReference) +
                        " of the reference have no counterpart and are ignored");
    if (of.framesAreUnknown)
        lines.emplace_back("the path is too short to check that both are in the same frame");
    if (!of.referenceFault.empty()) lines.push_back(of.referenceFault);
    return lines;
}

void bindMetrics(py::module_& module) {
    const auto value = [](double evaluation::ReportRow::*member) {
        return [member](const Comparison& of) { return of.row.*member; };
    };
    py::class_<Comparison>(module, "Metrics",
                           "Errors of a trajectory; NaN where the path is too short.")
        .def_property_readonly(
            "translation_percent", [](const Comparison& of) { return of.row.kitti.t_percent; },
            "KITTI's translation error, percent of the segments' lengths.")
        .def_property_readonly(
            "rotation_deg_per_100m",
            [](const Comparison& of) { return of.row.kitti.r_deg_per_100m; },
            "KITTI's rotation error, deg per 100 m.")
        .def_property_readonly(
            "segments", [](const Comparison& of) { return of.row.kitti.segments; },
            "Number of segments that both are means of.")
        .def_property_readonly("per_length", &perLengthOf,
                               "dict: length in metres to (percent, deg per 100 m).")
        .def_property_readonly("length_m", value(&evaluation::ReportRow::length_m),
                               "m; of the reference's path.")
        .def_property_readonly("ape_m", value(&evaluation::ReportRow::ape_m),
                               "m; APE, root mean square after rigid alignment without scale.")
        .def_property_readonly("rpe_m", value(&evaluation::ReportRow::rpe_m),
                               "m; RPE of the translation over `delta` poses, root mean square.")
        .def_property_readonly("rpe_deg", value(&evaluation::ReportRow::rpe_deg),
                               "deg; RPE of the rotation, likewise.")
        .def_readonly("end_error_m", &Comparison::end_error_m,
                      "m; between the last poses, relative to the first ones.")
        .def_property_readonly(
            "reference", [](const Comparison& of) { return arrayOf(of.reference); },
            "(N, 4, 4): the matched poses of the reference, metres.")
        .def_property_readonly(
            "estimate", [](const Comparison& of) { return arrayOf(of.estimate); },
            "(N, 4, 4): their counterparts.")
        .def_property_readonly(
            "step_errors_m",
            [](const Comparison& of) { return arrayOf(of.perScan.translations_m); },
            "(N - 1,): error of the translation from each pose to the next, metres.")
        .def_property_readonly(
            "step_errors_deg",
            [](const Comparison& of) { return arrayOf(of.perScan.rotations_deg); },
            "(N - 1,): error of the rotation from each pose to the next, degrees.")
        .def_property_readonly("warnings", &warningsOf, "A list of lines.");
}
}  // namespace

void bindEvaluation(py::module_& module) {
    bindMetrics(module);
    module.def(
        "evaluate", &compared, py::arg("reference"), py::arg("estimate"), py::kw_only(),
        py::arg("lengths") = std::vector<double>{}, py::arg("delta") = 1,
        py::arg("calibration") = py::none(),
        R"(Compares an estimated trajectory with a reference, as delio-eval does; returns Metrics.

reference, estimate: a pose file (KITTI or TUM), a folder of delio-slam, poses of shape (N, 4, 4) in
    metres, or a pair of such poses and stamps of shape (N,) in seconds. Poses are matched by stamps
    within 0.02 s where both have them, otherwise by row. Both have to be of the same moving frame.
lengths: of KITTI's segments, metres; empty: 100 to 800 m, or shorter ones for a path below 200 m.
delta: poses that RPE spans.
calibration: (4, 4), LiDAR to cam0 (Tr of calib.txt), which brings the estimate to cam0.
Raises delio.Error where no poses match or the moving frames differ.)");
}
}  // namespace delio::python
