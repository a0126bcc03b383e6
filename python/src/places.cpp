#include <utility>

#include "bindings.h"
#include "delio/core/geometry.h"
#include "delio/run/run_folder.h"
#include "delio/slam/localiser.h"

namespace delio::python {
namespace {
using MapPointer = std::shared_ptr<StoredMap>;

const StoredDrive& driveIn(const StoredMap& map, const std::string& name) {
    std::string known;
    for (const auto& drive : map.drives()) {
        if (drive.name == name) return drive;
        known += (known.empty() ? "" : ", ") + drive.name;
    }
    throw Error("'" + map.path() + "' has no drive '" + name + "'; it has: " + known);
}

void bindStoredMap(py::module_& module) {
    py::class_<StoredMap, MapPointer>(module, "StoredMap",
                                      R"(A map for localisation: map.delio of a run.

path: the file, or the folder of the run that made it.
Poses are the vehicle's in the map's frame: that of the first scan of its first drive.
Raises delio.Error if the file is missing, damaged, or of another version.)")
        .def(py::init([](const std::filesystem::path& path) {
                 const py::gil_scoped_release release;
                 return std::make_shared<StoredMap>(run::storedMapIn(path.string()));
             }),
             py::arg("path"))
        .def_property_readonly("path", &StoredMap::path, "Of the file.")
        .def_property_readonly(
            "drives",
            [](const StoredMap& map) {
                std::vector<std::string> names;
                for (const auto& drive : map.drives()) names.push_back(drive.name);
                return names;
            },
            "Names of the drives, a list of str.")
        .def(
            "trajectory",
            [](const StoredMap& map, const std::string& drive) {
                const auto trajectory = map.trajectory(driveIn(map, drive));
                return py::make_tuple(arrayOf(trajectory.poses), arrayOf(trajectory.stamps_s));
            },
            py::arg("drive"),
            "Poses (N, 4, 4) of a drive in the map's frame, metres, and stamps (N,), seconds.")
        .def(
            "cloud",
            [](const StoredMap& map, double spacing) {
                Eigen::Matrix3Xf points;
                {
                    const py::gil_scoped_release release;
                    points = map.cloud(spacing);
                }
                return pointsArrayOf(points);
            },
            py::arg("spacing") = 0.5,
            "float32 of shape (N, 3): the map's points, one in `spacing` metres; map frame, "
            "metres.");
}

const char* nameOf(Whereabouts where) {
    if (where == Whereabouts::kInMap) return "in_map";
    return where == Whereabouts::kOutside ? "outside" : "unknown";
}

/** The vehicle in the map; None where it is not found yet. */
template <class Get>
auto ofVehicle(const Get& get) {
    return [get](const MapFix& fix) -> py::object {
        if (fix.where == Whereabouts::kUnknown) return py::none();
        return get(fix.vehicle);
    };
}

/** What Localiser returns for a scan. */
struct PythonLocalisation {
    PythonStep step;
    MapFix fix;
};

void bindLocalisation(py::module_& module) {
    py::class_<PythonLocalisation>(module, "Localisation", "Result of a Localiser for one scan.")
        .def_readonly("step", &PythonLocalisation::step, "Step of the odometry.")
        .def_property_readonly(
            "where", [](const PythonLocalisation& of) { return nameOf(of.fix.where); },
            "'unknown' (not found yet), 'in_map' or 'outside' (the vehicle left the map: the pose "
            "is "
            "the odometry's since then).")
        .def_property_readonly(
            "pose",
            [](const PythonLocalisation& of) {
                return ofVehicle([](const Increment& vehicle) { return arrayOf(vehicle.pose); })(
                    of.fix);
            },
            "(4, 4): maps the vehicle's coordinates to the map's; metres. None while unknown.")
        .def_property_readonly(
            "covariance",
            [](const PythonLocalisation& of) {
                return ofVehicle([](const Increment& vehicle) {
                    return arrayOf(Eigen::MatrixXd(vehicle.covariance));
                })(of.fix);
            },
            "(6, 6): of the pose, [x y z wx wy wz], metres and radians, in the vehicle's frame. "
            "None "
            "while unknown.")
        .def_property_readonly(
            "measured", [](const PythonLocalisation& of) { return of.fix.measured; },
            "The pose was measured by registration to the map; otherwise by the odometry.")
        .def_property_readonly(
            "searched", [](const PythonLocalisation& of) { return of.fix.searched; },
            "A global search was made at this scan.")
        .def_property_readonly(
            "inlier_ratio", [](const PythonLocalisation& of) { return of.fix.inlierRatio; },
            "Fraction of the points above the ground that are in the map.")
        .def_property_readonly(
            "reason", [](const PythonLocalisation& of) { return of.fix.reason; },
            "Why the pose was not measured.");
}

/** A Localiser, and the odometry's pose beside it. */
class PythonLocaliser {
 public:
    PythonLocaliser(const MapPointer& map, const Options& options)
        : localiser_(map, options, options.placeSearch, options.localisation) {}

    void expect(const py::object& pose) {
        const InUse inUse(mutex_);
        localiser_.expect(poseIn(pose, "pose"));
    }

    PythonLocalisation process(const ScanArguments& arguments) {
        const Scan scan = scanOf(arguments, scans_);
        const py::gil_scoped_release release;
        const InUse inUse(mutex_);
        auto found = localiser_.process(scan);
        found.step.features.reset();
        if (scans_++ > 0)
            pose_ = pose_ * ofVehicle(found.step.increment, sensorPose_, scan.sensorPose).pose;
        sensorPose_ = scan.sensorPose;
        return {{std::move(found.step), pose_, scan.points->size()}, std::move(found.fix)};
    }

 private:
    Localiser localiser_;
    Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();        //!< by the odometry
    Eigen::Isometry3d sensorPose_ = Eigen::Isometry3d::Identity();  //!< at the scan before
    std::size_t scans_ = 0;
    std::mutex mutex_;
};
}  // namespace

void bindPlaces(py::module_& module) {
    bindStoredMap(module);
    bindLocalisation(module);
    py::class_<PythonLocaliser> localiser(
        module, "Localiser",
        R"(Localises a vehicle in a StoredMap, scan by scan, without an initial guess.

map: StoredMap.
profile, recording, options: as of Odometry; also place_search__key and localisation__key.
Memory does not grow with the number of scans.)");
    localiser
        .def(py::init([](const MapPointer& map, const std::string& profile,
                         const py::object& recording, const py::kwargs& options) {
                 return std::make_unique<PythonLocaliser>(map,
                                                          optionsOf(profile, recording, options));
             }),
             py::arg("map").none(false), py::arg("profile") = "accurate", py::kw_only(),
             py::arg("recording") = py::none())
        .def("expect", &PythonLocaliser::expect, py::arg("pose"),
             "Sets the approximate pose (4, 4) of the vehicle at the next scan, vehicle to map, "
             "accurate to a few metres; only its surroundings are searched.");
    defProcess(localiser, "Takes the next scan and returns a Localisation.");
}
}  // namespace delio::python
