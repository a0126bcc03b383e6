#include <mrpt/maps/CPointsMapXYZI.h>

#include <utility>

#include "bindings.h"
#include "delio/core/geometry.h"
#include "delio/picture/figures.h"
#include "delio/run/run.h"
#include "delio/run/run_folder.h"

namespace delio::python {
namespace fs = std::filesystem;

namespace {
/** Keeps the last step, which run::Run does not return. */
class LastStep : public SlamListener {
 public:
    const char* name() const override { return "python"; }
    void add(const SlamScan& scan) override {
        last = {scan.step, scan.pose, scan.scan.points->size()};
        last.step.features.reset();
    }

    PythonStep last;
};

/** A run of a program's own scans. */
class PythonSlam {
 public:
    PythonSlam(const Options& options, const run::RunSettings& settings)
        : options_(options), run_(options, settings), last_(std::make_shared<LastStep>()) {
        run_.attach(last_);
    }

    PythonStep process(const ScanArguments& arguments) {
        const Scan scan = scanOf(arguments, run_.record().rows.size());
        const py::gil_scoped_release release;
        const InUse inUse(mutex_);
        run_.process(scan);
        return std::move(last_->last);
    }

    void addImu(const ImuSample& sample) {
        const InUse inUse(mutex_);
        run_.addImu(sample);
    }

    std::optional<ImuReport> imuReport() {
        const InUse inUse(mutex_);
        return finished_ ? run_.record().imu : run_.imuReport();
    }

    void addOdometry(const OdometrySample& sample) {
        const InUse inUse(mutex_);
        run_.addOdometry(sample);
    }

    std::optional<OdometryReport> odometryReport() {
        const InUse inUse(mutex_);
        return finished_ ? run_.record().wheels : run_.odometryReport();
    }

    void finish() {
        const py::gil_scoped_release release;
        const InUse inUse(mutex_);
        finishOnce();
    }

    const run::RunRecord& result() {
        finish();
        return run_.record();
    }

    Eigen::Matrix3Xf cloud() {
        const py::gil_scoped_release release;
        const InUse inUse(mutex_);
        finishOnce();
        if (run_.maps().points == nullptr) throw Error("there is no map: 'build_map' is False");
        const auto points = run_.maps().points->build(run_.record().final.poses).points;
        Eigen::Matrix3Xf positions(3, static_cast<Eigen::Index>(points.size()));
        for (std::size_t i = 0; i < points.size(); ++i)
            positions.col(static_cast<Eigen::Index>(i)) = points[i].position;
        return positions;
    }

    void save(const fs::path& folder, bool pictures) {
        const py::gil_scoped_release release;
        const InUse inUse(mutex_);
        finishOnce();
        const auto fault = run::RunFolder(folder.string())
                               .write(run_.record(), run_.maps(),
                                      pictures ? picture::illustrate : run::Illustrate{});
        if (!fault.empty()) throw Error(fault);
    }

 private:
    void finishOnce() {
        if (run_.record().rows.empty()) throw Error("no scan was processed yet");
        if (!finished_) run_.finish(true);
        finished_ = true;
    }

    Options options_;
    run::Run run_;
    std::shared_ptr<LastStep> last_;
    bool finished_ = false;
    std::mutex mutex_;
};

constexpr const char* kSlamText =
    R"(Odometry, pose graph with loop closures, and map of your own scans.

profile, recording, options: as of Odometry.
drive: name of the drive in the stored map.
map: a stored map (file or folder) in which the drive is localised; initial_pose: (4, 4) of the
    vehicle at the first scan in it; extend: add the drive to it.
loops, graph, build_map: False leaves them out.
Memory grows by poses and, in the end, by the map; scans wait on the disk.)";
}  // namespace

void bindSlam(py::module_& module) {
    py::class_<PythonSlam> slam(module, "Slam", kSlamText);
    slam.def(
        py::init([](const std::string& profile, const py::object& recording,
                    const std::string& drive, const OptionalPath& map,
                    const py::object& initialPose, bool extend, bool loops, bool graph,
                    bool buildMap, const py::kwargs& options) {
            run::RunSettings settings;
            settings.profile = profile;
            settings.drive = drive;
            if (!recording.is_none() && py::isinstance<Scans>(recording))
                settings.sensorLabel = recording.cast<const Scans&>().in->label();
            settings.storedMap = textOf(map);
            if (!initialPose.is_none()) settings.initialPose = poseIn(initialPose, "initial_pose");
            settings.extend = extend;
            settings.loops = loops;
            settings.graph = graph;
            settings.map = buildMap;
            return std::make_unique<PythonSlam>(optionsOf(profile, recording, options), settings);
        }),
        py::arg("profile") = "accurate", py::kw_only(), py::arg("recording") = py::none(),
        py::arg("drive") = "drive", py::arg("map") = py::none(),
        py::arg("initial_pose") = py::none(), py::arg("extend") = false, py::arg("loops") = true,
        py::arg("graph") = true, py::arg("build_map") = true);
    defProcess(slam, "Processes the next scan and returns its Step, by the odometry alone.");
    defImu(slam);
    defOdometry(slam);
    slam.def("finish", &PythonSlam::result, py::return_value_policy::copy,
             "Closes loops, optimises the pose graph and returns a RunResult. No scan is accepted "
             "afterwards.")
        .def(
            "cloud", [](PythonSlam& self) { return pointsArrayOf(self.cloud()); },
            "Ends the drive as finish() and returns the static points of the map: float32 of shape "
            "(N, 3), in the frame of the final poses, metres.")
        .def("save", &PythonSlam::save, py::arg("folder"), py::arg("pictures") = true,
             "Ends the drive as finish() and writes all result files of delio-slam into a folder. "
             "Raises delio.Error if something could not be written.");
}
}  // namespace delio::python
