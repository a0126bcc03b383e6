#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <array>
#include <utility>

#include "bindings.h"
#include "delio/core/geometry.h"

namespace delio::python {
using mrpt::maps::CPointsMapXYZI;

namespace {
void requireAlone(const ScanArguments& a) {
    const std::array<std::pair<const char*, const py::object*>, 5> others{
        {{"stamp", &a.stamp},
         {"times", &a.times},
         {"rings", &a.rings},
         {"intensity", &a.intensity},
         {"sensor_pose", &a.sensorPose}}};
    for (const auto& [name, value] : others)
        if (!value->is_none())
            throw Error(std::string("a Scan has its own '") + name + "'; leave it out");
}

double stampIn(const py::object& stamp) {
    const double stamp_s = PyFloat_AsDouble(stamp.ptr());
    if (!PyErr_Occurred()) return stamp_s;
    PyErr_Clear();
    throw Error("'stamp' must be the time of the points in seconds, a number");
}
}  // namespace

Scan scanOf(const ScanArguments& arguments, std::size_t index) {
    if (py::isinstance<Scan>(arguments.points)) {
        requireAlone(arguments);
        return arguments.points.cast<Scan>();
    }
    Scan scan;
    scan.index = index;
    if (arguments.intensity.is_none()) {
        scan.points = cloudIn(arguments.points, "points", mrpt::maps::CSimplePointsMap::Create());
    } else {
        const auto cloud = CPointsMapXYZI::Create();
        scan.points = cloudIn(arguments.points, "points", cloud);
        const auto intensity = columnIn<float>(arguments.intensity, "intensity", cloud->size());
        for (std::size_t i = 0; i < intensity.size(); ++i)
            cloud->setPointColor_fast(i, intensity[i], 0, 0);
    }
    scan.stamp_s = stampIn(arguments.stamp);
    scan.time = mrpt::Clock::fromDouble(scan.stamp_s);
    scan.times_s = columnIn<float>(arguments.times, "times", scan.points->size());
    scan.rings = columnIn<std::uint16_t>(arguments.rings, "rings", scan.points->size());
    if (!arguments.sensorPose.is_none())
        scan.sensorPose = poseIn(arguments.sensorPose, "sensor_pose");
    return scan;
}

namespace {
py::array_t<float> pointsOf(const Scan& scan) {
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    py::array_t<float> array({static_cast<py::ssize_t>(x.size()), py::ssize_t{3}});
    float* to = array.mutable_data();
    for (std::size_t i = 0; i < x.size(); ++i) {
        *to++ = x[i];
        *to++ = y[i];
        *to++ = z[i];
    }
    return array;
}

py::object intensityOf(const Scan& scan) {
    const auto cloud = std::dynamic_pointer_cast<CPointsMapXYZI>(scan.points);
    if (!cloud) return py::none();
    py::array_t<float> array(static_cast<py::ssize_t>(cloud->size()));
    for (std::size_t i = 0; i < cloud->size(); ++i)
        array.mutable_data()[i] = cloud->getPointIntensity_fast(i);
    return array;
}

/** An array, or None where the source has no such numbers. */
template <class Number>
py::object arrayOrNone(const std::vector<Number>& numbers) {
    return numbers.empty() ? py::object(py::none()) : py::object(arrayOf(numbers));
}

void bindScan(py::module_& module) {
    py::class_<Scan>(module, "Scan", R"(One scan of a LiDAR, as its source gives it.

points: float32 or float64 array of shape (N, 3); metres, sensor frame (x forward, y left, z up).
    NaN points may be among them.
stamp: seconds; has to increase from scan to scan.
times: float32 or float64 of shape (N,); seconds from the stamp (negative: before it), for
    de-skewing. None where they are not known.
rings: integers of shape (N,); ring (laser) of each point. None where they are not known.
intensity: numbers of shape (N,), or None.
sensor_pose: (4, 4); maps sensor coordinates to vehicle coordinates. None: identity.
index: number of the scan in messages.
Raises delio.Error for a wrong shape or type.)")
        .def(py::init([](const py::object& points, const py::object& stamp, const py::object& times,
                         const py::object& rings, const py::object& intensity,
                         const py::object& sensorPose, std::size_t index) {
                 return scanOf({points, stamp, times, rings, intensity, sensorPose}, index);
             }),
             py::arg("points"), py::arg("stamp"), py::arg("times") = py::none(),
             py::arg("rings") = py::none(), py::arg("intensity") = py::none(),
             py::arg("sensor_pose") = py::none(), py::arg("index") = 0)
        .def("__len__", [](const Scan& scan) { return scan.points->size(); })
        .def_readonly("index", &Scan::index, "Number of the scan in its recording, from 0.")
        .def_readonly("stamp", &Scan::stamp_s, "Seconds.")
        .def_property_readonly("points", &pointsOf,
                               "A new float32 array of shape (N, 3): metres, sensor frame.")
        .def_property_readonly(
            "times", [](const Scan& scan) { return arrayOrNone(scan.times_s); },
            "A new float32 array of shape (N,): seconds from the stamp; or None.")
        .def_property_readonly(
            "rings", [](const Scan& scan) { return arrayOrNone(scan.rings); },
            "A new uint16 array of shape (N,): ring of each point; or None.")
        .def_property_readonly("intensity", &intensityOf,
                               "A new float32 array of shape (N,), or None.")
        .def_property_readonly(
            "sensor_pose", [](const Scan& scan) { return arrayOf(scan.sensorPose); },
            "(4, 4): maps sensor coordinates to vehicle coordinates; metres.");
}

/** The next scan; ends Python's loop at the end of the recording. */
Scan nextOf(Scans& scans) {
    std::optional<Scan> scan;
    {
        const py::gil_scoped_release release;
        const InUse inUse(scans.mutex);
        scan = scans.in->next();
    }
    if (!scan) throw py::stop_iteration();
    return std::move(*scan);
}
}  // namespace

std::vector<io::VehiclePart> vehicleIn(const py::object& object) {
    if (object.is_none()) return {};
    if (py::isinstance<py::str>(object) || py::hasattr(object, "__fspath__"))
        return io::vehiclePartsIn(object.cast<std::filesystem::path>().string());
    if (!py::isinstance<py::sequence>(object) || py::len(object) != 2)
        throw Error("'vehicle_box' must be a file or two corners, each of shape (3,)");
    const py::sequence corners = object;
    io::VehiclePart part;
    for (const auto& corner : corners) part.box.extend(vectorIn(corner, "vehicle_box"));
    part.name = "the vehicle box";
    return {part};
}

void bindScans(py::module_& module) {
    bindScan(module);
    py::class_<Scans>(module, "Scans",
                      "The scans of a recording, in order; see open_scans(). Iterate over it once.")
        .def("__iter__", [](py::object self) { return self; })
        .def("__next__", &nextOf)
        .def_readonly("path", &Scans::path, "Of the recording.")
        .def_property_readonly(
            "sensor_label", [](const Scans& scans) { return scans.in->label(); },
            "Name of the sensor that is read: label in a rawlog, topic in a bag.")
        .def_property_readonly(
            "description", [](const Scans& scans) { return io::describe(scans.in->recording()); },
            "One line: sensor, rate, times of points, format.")
        .def_property_readonly(
            "warnings",
            [](const Scans& scans) {
                const auto recording = scans.in->recording();
                auto lines = recording.warnings;
                lines.insert(lines.end(), recording.findings.begin(), recording.findings.end());
                return lines;
            },
            "One line for each missing part, and for each kind of scan or point that was ignored "
            "or "
            "corrected so far.")
        .def(
            "take_imu",
            [](Scans& scans) {
                const InUse inUse(scans.mutex);
                return scans.in->takeImu();
            },
            "list of ImuSample: samples of the recording's IMU that were read since the last call, "
            "in their order.")
        .def(
            "take_odometry",
            [](Scans& scans) {
                const InUse inUse(scans.mutex);
                return scans.in->takeOdometry();
            },
            "list of OdometrySample: the same of the recording's wheel odometry.")
        .def_property_readonly(
            "calibration",
            [](const Scans& scans) -> py::object {
                const auto file = scans.in->calibration();
                if (file.text.empty()) return py::none();
                const auto found = io::calibrationIn(file.text, file.name);
                return found.hasTr ? py::object(arrayOf(found.Tr)) : py::none();
            },
            "(4, 4): maps LiDAR coordinates to KITTI's cam0; None where there is no Tr.");
    module.def(
        "open_scans",
        [](const std::filesystem::path& path, const std::string& label,
           const OptionalPath& sensorFile, const OptionalPath& images,
           const OptionalPath& extrinsics, const py::object& vehicleBox) {
            io::ScanSource source{path.string(), label, textOf(images), textOf(sensorFile)};
            source.extrinsicsFile = textOf(extrinsics);
            source.vehicle = vehicleIn(vehicleBox);
            const py::gil_scoped_release release;
            auto scans = std::make_unique<Scans>();
            scans->path = source.path;
            scans->in = io::openScans(source);
            return scans;
        },
        py::arg("path"), py::kw_only(), py::arg("sensor_label") = "",
        py::arg("sensor_file") = py::none(), py::arg("images") = py::none(),
        py::arg("extrinsics") = py::none(), py::arg("vehicle_box") = py::none(),
        R"(Opens a recording and returns its Scans; everything that `delio-slam -i` reads.

path: rawlog, KITTI folder, folder of .pcd, .ply, .bin, .txt or .csv, ROS 1 or 2 bag, MCAP, or pcap
    of a Velodyne or Ouster; the format is detected from the content.
sensor_label: the sensor to read: label in a rawlog, topic in a bag; empty: the first one;
    several, with commas between them, or 'all': merged in the frame of the first.
sensor_file: an Ouster's json or a Velodyne's calibration; empty: the one beside the recording.
images: folder of a rawlog's external files; empty: beside it.
extrinsics: file with the sensors' poses in the vehicle, lines LABEL x y z yaw pitch roll (metres, degrees).
vehicle_box: two corners ((x, y, z), (x, y, z)), metres; points in this box of the vehicle's frame are left out.
    Or a file with boxes and sectors, as of delio-slam --vehicle-box.
Raises delio.Error if there is nothing to read or the format is unknown.)");
}
}  // namespace delio::python
