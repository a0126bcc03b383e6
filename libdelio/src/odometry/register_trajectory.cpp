#include "odometry/register_trajectory.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/scan_trajectory.h"
#include "core/voxel_grid.h"
#include "odometry/register_planes.h"

namespace delio::odometry {
namespace {
/** The polynomial's coefficients, a rotation vector and a translation each, in the map's axes: the
 *  pose at the stamp, and what acceleration and jerk add to the way there and beyond. */
constexpr Eigen::Index kDegree = 3;
using Coefficients = Eigen::Matrix<double, 6 * kDegree, 1>;
using Shares = Eigen::Matrix<double, kDegree, 1>;

/** What each coefficient counts at `time_s` from the stamp: nothing where the pose is known; the
 *  latter two nothing at the stamp either. */
Shares sharesAt(double time_s, double since_s) {
    const double way = 1 + time_s / since_s;
    return {way, way * (way - 1), way * (way - 1) * (way + 1)};
}

/** 1 over the variance of each. */
Coefficients informationOf(const TrajectoryPrior& prior) {
    // Speeds that differ by a T from one interval to the next, on average, lead a T^2 astray;
    // within an interval the way is off by a T^2 / 2 (t/T) (t/T - 1), and by a jerk of a / T as the
    // third.
    constexpr double kAcceleration = 1.0 / 2, kJerk = 1.0 / 6;
    const Eigen::Vector3d one = Eigen::Vector3d::Ones(),
                          turn = one / std::pow(prior.unevenRotation, 2),
                          move = one / std::pow(prior.unevenTranslation, 2);
    Coefficients information;
    information << one / std::pow(prior.rotation, 2), one / std::pow(prior.translation, 2),
        turn / std::pow(kAcceleration, 2), move / std::pow(kAcceleration, 2),
        turn / std::pow(kJerk, 2), move / std::pow(kJerk, 2);
    return information;
}

/** Normal equations of the coefficients. Points that were measured at about the same time come
 *  together as six unknowns, the motion at that time. */
class Equations {
 public:
    void add(double time_s, double since_s, const Vector6& jacobian, double residual,
             double weight) {
        constexpr double kTogether = 1.0 / 64;  // of the time between the scans
        const double slot = std::floor(time_s / (kTogether * since_s));
        if (slot != slot_) {
            close();
            slot_ = slot;
            shares_ = sharesAt((slot + 0.5) * kTogether * since_s, since_s);
        }
        together_.add(jacobian, residual, weight);
        ++count_;
    }
    void operator+=(Equations other) {
        close();
        other.close();
        sums_ += other.sums_;
        count_ += other.count_;
    }
    /** The sums, and of how many points. */
    std::pair<NormalEquations<6 * kDegree>, std::size_t> closed() && {
        close();
        return {sums_, count_};
    }

 private:
    /** Adds what is still apart. Of the information the lower triangle is all that is used. */
    void close() {
        for (Eigen::Index i = 0; i < kDegree; ++i) {
            sums_.gradient.segment<6>(6 * i) += shares_[i] * together_.gradient;
            for (Eigen::Index j = 0; j <= i; ++j)
                sums_.information.block<6, 6>(6 * i, 6 * j) +=
                    shares_[i] * shares_[j] * together_.information;
        }
        sums_.weight += together_.weight;
        sums_.cost += together_.cost;
        together_ = {};
    }

    NormalEquations<6 * kDegree> sums_;
    std::size_t count_ = 0;  //!< of points
    NormalEquations<6> together_;
    double slot_ = NAN;
    Shares shares_ = Shares::Zero();
};

/** Of the points next to planes, with a kernel of that width. */
Equations equationsOf(Matcher& matcher, const TimedPoints& scan, const PoseTable& poses,
                      double since_s, double width) {
    return matcher.sumAt<Equations>(
        [&](std::size_t i) -> Eigen::Vector3d {
            return poses.at(scan.times_s[i]) * scan.points.col(static_cast<Eigen::Index>(i));
        },
        width,
        [&](std::size_t i, const Eigen::Vector3d& placed, const Plane& plane, double weight,
            Equations& sum) {
            const double time_s = scan.times_s[i];
            const Eigen::Vector3d normal = plane.normal();
            Vector6 jacobian;
            jacobian << (placed - poses.placeAt(time_s)).cross(normal), normal;
            sum.add(time_s, since_s, jacobian, normal.dot(placed - plane.mean), weight);
        });
}

ScanTrajectory bent(const ScanTrajectory& trajectory, const Coefficients& step, double since_s) {
    auto poses = trajectory.poses();
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto shares = sharesAt(trajectory.times_s()[i], since_s);
        Vector6 move = Vector6::Zero();
        for (Eigen::Index k = 0; k < kDegree; ++k) move += shares[k] * step.segment<6>(6 * k);
        const Eigen::Matrix3d R = rotationExp(move.head<3>()) * poses[i].linear();
        poses[i] = isometry(normalised(R), poses[i].translation() + move.tail<3>());
    }
    return {trajectory.times_s(), poses};
}
}  // namespace

TimedPoints sampled(const TimedPoints& all, Eigen::Index most) {
    TimedPoints few{sample(all.points, most), {}};
    const Eigen::Index stride = strideOf(all.points.cols(), most);
    for (Eigen::Index i = 0; i < few.points.cols(); ++i)
        few.times_s.push_back(all.times_s[static_cast<std::size_t>(i * stride)]);
    return few;
}

namespace {
/** What the iterations have come to. */
struct Bending {
    ScanTrajectory trajectory;
    Coefficients sinceStart = Coefficients::Zero();
};

/** With one kernel. False where too few points lie on planes. */
bool bend(Matcher& matcher, const TimedPoints& scan, double since_s, const Coefficients& known,
          double width, double converged, const PlaneRegistrationOptions& options, Bending& now) {
    constexpr unsigned kIterations = 6;
    constexpr double kLeastFactor = 0.01;
    const auto [least, most] = std::minmax_element(scan.times_s.begin(), scan.times_s.end());
    for (unsigned i = 0; i < kIterations; ++i) {
        const PoseTable poses(now.trajectory, *least, *most);
        auto [equations, matches] = equationsOf(matcher, scan, poses, since_s, width).closed();
        if (matches < options.min_matches) return false;
        // As in registerToPlanes(): points of one surface err together.
        const double factor =
            std::max(equations.cost / static_cast<double>(matches), kLeastFactor) /
            plane_tuning::kIndependentRatio;
        equations.information.diagonal() += factor * known;
        equations.gradient += factor * known.cwiseProduct(now.sinceStart);
        const Coefficients step = -equations.information.ldlt().solve(equations.gradient);
        now.trajectory = bent(now.trajectory, step, since_s);
        now.sinceStart += step;
        if (step.norm() < converged) break;
    }
    return true;
}
}  // namespace

ScanTrajectory registerTrajectory(const PlaneMap& map, const TimedPoints& scan,
                                  const ScanTrajectory& trajectory, double since_s,
                                  const TrajectoryPrior& prior, double kernel,
                                  const PlaneRegistrationOptions& options) {
    // A steady motion is nearly known: few points lead near to where all of them do. Of a swing,
    // all are needed.
    constexpr Eigen::Index kFew = 1000;
    constexpr double kSwing_m = 1;  // predictions are off by more
    // From where few points have led, one step of all of them comes near enough.
    constexpr double kConverged = 4e-4, kRough = 1e-3, kNear = 3e-3;
    if (scan.times_s.empty()) return trajectory;
    const bool isSwing = kernel >= kSwing_m;
    const Coefficients known = informationOf(prior);
    const TimedPoints few = sampled(scan, isSwing ? scan.points.cols() : kFew);
    const bool isAll = few.points.cols() == scan.points.cols();
    const double first = isSwing ? kernel : std::min(kernel, 2 * options.last_kernel);
    Bending now{trajectory};
    Matcher matchesFew(map, few.points, plane_tuning::kPointSigma_m);
    for (double width = std::max(first, options.last_kernel);;
         width = std::max(width / 2, options.last_kernel)) {
        const double converged = width <= options.last_kernel && isAll ? kConverged : kRough;
        if (!bend(matchesFew, few, since_s, known, width, converged, options, now))
            return trajectory;
        if (width <= options.last_kernel) break;
    }
    if (isAll) return now.trajectory;
    Matcher matchesAll(map, scan.points, plane_tuning::kPointSigma_m);
    return bend(matchesAll, scan, since_s, known, options.last_kernel, kNear, options, now)
               ? now.trajectory
               : trajectory;
}

TimedPoints timedPoints(const PointCloud& cloud, const std::vector<Eigen::Index>& columns) {
    TimedPoints picked{cloud.points(Eigen::all, columns).cast<double>(), {}};
    picked.times_s.reserve(columns.size());
    for (const Eigen::Index column : columns)
        picked.times_s.push_back(double{cloud.times_s[static_cast<std::size_t>(column)]});
    return picked;
}

ScanTrajectory constantTwist(const KnownEnds& known, const PointCloud& cloud) {
    constexpr unsigned kParts = 8;
    const auto [least, most] = rangeOf(cloud.times_s);
    const double start_s = -known.since_s, first_s = std::max(start_s, double{least}),
                 last_s = std::max(0.0, double{most});
    // Before the scan one part: of a bend only its mean can be extrapolated, to a scan before.
    std::vector<double> times_s;
    if (first_s > start_s) times_s.push_back(start_s);
    for (unsigned k = 0; k <= (last_s > first_s ? kParts : 0); ++k)
        times_s.push_back(first_s + k * (last_s - first_s) / kParts);
    return ScanTrajectory::even(times_s, known.reference,
                                Twist::of(known.reference.inverse() * known.pose, known.since_s));
}

ScanTrajectory refinedTrajectory(const PlaneMap& map, const ScanTrajectory& start, double since_s,
                                 const PointCloud& cloud, const ScanView& view,
                                 const Unevenness& unevenness, double kernel,
                                 const ScaledOptions& options) {
    const double most_m = options.spacing.acceleration * since_s * since_s;
    return registerTrajectory(map, timedPoints(cloud, firstsForPlanes(view)), start, since_s,
                              unevenness.prior(most_m), kernel, options.registration);
}

namespace {
/** True where points along the trajectory hardly lie elsewhere than where they were placed. */
bool isAlong(const ScanTrajectory& trajectory, const PlacedScan& placed,
             const ScaledOptions& options) {
    const double near_m = options.points.last_kernel / 2;
    const auto& times_s = trajectory.times_s();
    return std::all_of(times_s.begin(), times_s.end(), [&](double time_s) {
        const Eigen::Isometry3d before = placed.estimate.pose * placed.motion.at(time_s);
        return stepBetween(before, trajectory.at(time_s)).norm() < near_m;
    });
}
}  // namespace

std::optional<ScanOnTrajectory> registerAlong(const ScanTrajectory& trajectory,
                                              const KnownEnds& known, const LocalMap& map,
                                              const PointCloud& cloud, const ScanView& view,
                                              const ScaledOptions& options) {
    const ScanTrajectory motion = trajectory.seenFrom(0);
    ScanView again;
    if (known.isNearPrediction) {
        again = undistortedAgain(cloud, motion, view);
    } else {
        again = undistortedAnew(cloud, motion, view.dynamic, options.spacing.map_spacing,
                                options.spacing.scan_spacing);
        thinForPoints(again, known.upright, options.spacing.point_spacing, known.byStanding);
    }
    std::optional<Eigen::Isometry3d> start;
    if (known.placed) start = trajectory.at(0);
    const auto registered = [&](const PointEstimate& placed) {
        return map.registerPlanes(again, placed, known.pose, known.motion, start);
    };
    if (known.isNearPrediction && known.placed && isAlong(trajectory, *known.placed, options)) {
        const auto& placed = known.placed->estimate;
        auto estimate = registered(placed);
        if (estimate.isByPlanes)
            return ScanOnTrajectory{std::move(again), estimate, trajectory, placed.inlierRatio};
    }
    const auto placed =
        map.levelled(again, map.place(again.coarse, trajectory.at(0), options.points.least_kernel));
    if (!placed.valid) return {};
    auto estimate = registered(placed);
    return ScanOnTrajectory{std::move(again), std::move(estimate), trajectory, placed.inlierRatio};
}

Extrapolation::Extrapolation(const ScanTrajectory& trajectory, double over_s)
    : end_s_(trajectory.times_s().back()),
      end_(trajectory.poses().back()),
      motion_(Twist::of(trajectory.at(end_s_ - over_s).inverse() * end_, over_s)) {}

Eigen::Isometry3d atStamp(const ScanTrajectory& motion, double stamp_s) {
    const double first_s = motion.times_s().front(), last_s = motion.times_s().back();
    const double inside_s = std::clamp(stamp_s, first_s, last_s);
    if (inside_s == stamp_s || first_s == last_s) return motion.at(stamp_s);
    const auto mean = Twist::of(motion.at(first_s).inverse() * motion.at(last_s), last_s - first_s);
    return motion.at(inside_s) * mean.after(stamp_s - inside_s);
}
}  // namespace delio::odometry
