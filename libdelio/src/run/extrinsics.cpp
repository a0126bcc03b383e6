#include <algorithm>
#include <cmath>
#include <deque>
#include <random>
#include <utility>

#include "core/scan_trajectory.h"
#include "core/voxel_grid.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/run/playback.h"
#include "odometry/calibrate_extrinsics.h"
#include "odometry/preprocess.h"
#include "odometry/spin_axis.h"
#include "odometry/tuning.h"

namespace delio::run {
namespace {
using odometry::CalibrationView;

constexpr std::size_t kAround = 15;  // scans before and after a moment are in its map
constexpr double kNear_s = 0.15;     // scans of the other sensor so near a moment are compared
constexpr double kLongest_s = 0.5;   // from a moment to the points of these scans
constexpr std::ptrdiff_t kFewestViews = 10;  // otherwise the drive shows too little

/** Moments of the drive. */
struct Views {
    std::vector<double> stamps_s;
    std::vector<CalibrationView> views;  //!< at these stamps
};

/** Makes maps of the first sensor's scans, in the vehicle's frame, about moments at equal distances
 *  along the drive: their number does not grow with it. */
class Moments : public SlamListener {
 public:
    explicit Moments(const PlaneOdometryOptions& options) : options_(options) {}

    const char* name() const override { return "extrinsics"; }
    void add(const SlamScan& scan) override;
    Views take() { return std::move(all_); }

 private:
    struct Placed {
        std::size_t node;
        double stamp_s;
        Eigen::Isometry3d pose;   //!< of the vehicle
        Eigen::Matrix3Xf points;  //!< vehicle's frame
    };
    void addMoment(const Eigen::Vector3d& up);

    PlaneOdometryOptions options_;
    std::deque<Placed> recent_;
    Views all_;
    double scale_ = 1;                   //!< of the place
    double stride_m_ = 1, way_m_ = 1e9;  //!< between two moments, and since the latest
};

void Moments::add(const SlamScan& scan) {
    constexpr double kSpacing_m = 0.1, kArm_m = 3;  // a rotation by 1 rad shows as much as 3 m do
    for (const auto& [name, value] : scan.step.details)
        if (name == "scale") scale_ = value;
    for (const auto& [node, pose] : scan.corrected)
        for (auto& placed : recent_)
            if (placed.node == node) placed.pose = pose;
    if (scan.fromOldPose && !recent_.empty() && recent_.back().node + 1 == scan.node) {
        auto& points = recent_.back().points;
        points = (scan.fromOldPose->cast<float>() * points).eval();
    }
    if (scan.step.predicted || scan.step.lost || scan.step.interrupted ||
        (!recent_.empty() && scan.scan.stamp_s <= recent_.back().stamp_s))
        recent_.clear();
    if (scan.step.predicted) return;
    recent_.push_back({scan.node, scan.scan.stamp_s, scan.pose,
                       voxelCentroids(staticPoints(scan), kSpacing_m * scale_)});
    way_m_ +=
        scan.increment.pose.translation().norm() + kArm_m * angleOf(scan.increment.pose.linear());
    if (recent_.size() <= 2 * kAround) return;
    if (way_m_ >= stride_m_ * scale_)
        addMoment(odometry::upIn(scan.scan.sensorPose, scan.step.used.points));
    recent_.pop_front();
}

/** In the middle of the recent scans. */
void Moments::addMoment(const Eigen::Vector3d& up) {
    constexpr std::size_t kMost = 80;
    const Placed& centre = recent_[kAround];
    odometry::PlaneMap map(odometry::atScale(options_, scale_).map, up);
    std::vector<double> times_s;
    std::vector<Eigen::Isometry3d> poses;
    for (const Placed& placed : recent_) {
        times_s.push_back(placed.stamp_s - centre.stamp_s);
        poses.push_back(centre.pose.inverse() * placed.pose);
        map.add(poses.back() * placed.points.cast<double>());
    }
    const ScanTrajectory trajectory(times_s, poses);
    all_.stamps_s.push_back(centre.stamp_s);
    all_.views.push_back({std::move(map), PoseTable(trajectory, -kLongest_s, kLongest_s)});
    way_m_ = 0;
    if (all_.views.size() < kMost) return;
    Views half;
    for (std::size_t i = 0; i < all_.views.size(); i += 2) {
        half.stamps_s.push_back(all_.stamps_s[i]);
        half.views.push_back(std::move(all_.views[i]));
    }
    all_ = std::move(half);
    stride_m_ *= 2;
}

/** Appends a scan of the other sensor, thinned at random to about kPoints, evenly over surfaces:
 *  with the square of the range. (Where voxels thin a scan, noise decides which point is kept, and
 *  the kept points are off towards one side.) */
void addPoints(const Scan& scan, const PreprocessOptions& options, double stamp_s,
               CalibrationView& view) {
    constexpr float kPoints = 3000;
    const auto cloud = odometry::preprocess(scan, options);
    const Eigen::RowVectorXf squared = cloud.points.colwise().squaredNorm();
    const float part = kPoints / std::max(squared.sum(), 1.0F);
    std::mt19937 random(static_cast<unsigned>(scan.index));
    auto& points = view.points;
    Eigen::Index count = points.cols();
    points.conservativeResize(3, count + cloud.points.cols());
    for (Eigen::Index i = 0; i < cloud.points.cols(); ++i) {
        const auto draw = static_cast<float>(random()) / static_cast<float>(std::mt19937::max());
        if (draw > part * squared[i]) continue;
        points.col(count++) = cloud.points.col(i);
        const float time_s = cloud.times_s.empty() ? 0 : cloud.times_s[static_cast<std::size_t>(i)];
        view.times_s.push_back(static_cast<float>(scan.stamp_s - stamp_s) + time_s);
    }
    points.conservativeResize(3, count);
}

io::ScanSource only(io::ScanSource source, const std::string& label) {
    source.label = label;
    return source;
}

/** From the odometry of the sensor that `source` names alone. */
Views viewsOf(const io::ScanSource& source, const Options& options,
              const PlaybackSettings& settings,
              const std::function<void(std::optional<double>)>& onScan) {
    const auto reader = io::openScans(source);
    Playback playback(*reader, settings);
    RunSettings run;
    run.graph = run.map = run.loops = false;
    Run drive(options, run);
    const auto moments = std::make_shared<Moments>(options.planes);
    drive.attach(moments);
    playback.play(drive, [&](const RunRow&, const Playback::Progress& now) {
        if (onScan) onScan(now.fraction);
    });
    return moments->take();
}

/** Gives the views the points of the sensor that `source` names. A recording that is damaged is
 *  used up to there: the run of all sensors says so. */
void addPoints(const io::ScanSource& source, const PreprocessOptions& options,
               const std::function<bool()>& isInterrupted, Views& all) {
    for (auto& view : all.views) {
        view.points.resize(3, 0);
        view.times_s.clear();
    }
    const auto reader = io::openScans(source);
    try {
        while (const auto scan = reader->next()) {
            if (isInterrupted && isInterrupted()) return;
            for (std::size_t i = 0; i < all.views.size(); ++i)
                if (std::abs(scan->stamp_s - all.stamps_s[i]) <= kNear_s)
                    addPoints(*scan, options, all.stamps_s[i], all.views[i]);
        }
    } catch (const Error&) {
        return;
    }
}

/** "along x": by the vehicle's axis nearest to each unit vector. */
void addNames(const char* how, const Eigen::Matrix3Xd& axes, std::vector<std::string>& names) {
    for (Eigen::Index i = 0; i < axes.cols(); ++i) {
        Eigen::Index nearest = 0;
        axes.col(i).cwiseAbs().maxCoeff(&nearest);
        names.push_back(std::string(how) + " " + "xyz"[nearest]);
    }
}

/** Refines `sensor`, or says why not. */
void refine(const std::vector<CalibrationView>& views, PlaneRegistrationOptions options,
            CalibratedSensor& sensor) {
    constexpr double kPrior_m = 0.2, kPrior_deg = 3;
    options.prior_sigma = kPrior_m;
    options.prior_sigma_deg = kPrior_deg;
    const auto count = std::count_if(views.begin(), views.end(),
                                     [](const auto& view) { return view.points.cols() > 0; });
    if (count < kFewestViews) {
        sensor.reason = "the drive has " + std::to_string(count) +
                        " places where both see enough, " + std::to_string(kFewestViews) +
                        " are needed";
        return;
    }
    const auto found = odometry::calibrateExtrinsics(views, sensor.given, options);
    if (!found.estimate.valid || !found.estimate.rotation.converged) {
        sensor.reason = "its points do not meet the surfaces that the first sensor saw";
        return;
    }
    sensor.pose = normalised(found.estimate.pose());
    sensor.matches = found.estimate.rotation.matches;
    sensor.sigma = found.covariance.diagonal().cwiseSqrt();
    addNames("along", found.estimate.translation.unobservedAxes, sensor.unobserved);
    addNames("about", sensor.pose.linear() * found.estimate.rotation.unobservedAxes,
             sensor.unobserved);
}
}  // namespace

std::vector<CalibratedSensor> calibrateExtrinsics(
    const io::ScanSource& source, const Options& options, PlaybackSettings settings,
    const std::function<void(std::optional<double> fraction)>& onScan) {
    std::vector<CalibratedSensor> sensors;
    for (const auto& [label, pose] : io::openScans(source)->mergedSensors()) {
        sensors.emplace_back();
        sensors.back().label = label;
        sensors.back().pose = sensors.back().given = pose;
    }
    if (sensors.size() < 2)
        throw Error("the poses of sensors can be refined where several are merged: '" +
                    source.path + "' gives one");
    settings.gnss = false;
    auto views = viewsOf(only(source, sensors.front().label), options, settings, onScan);
    for (std::size_t i = 1; i < sensors.size(); ++i) {
        addPoints(only(source, sensors[i].label), options.scan(), settings.isInterrupted, views);
        refine(views.views, options.planes.registration, sensors[i]);
    }
    return sensors;
}
}  // namespace delio::run
