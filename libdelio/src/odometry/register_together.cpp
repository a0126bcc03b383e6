#include "odometry/register_together.h"

#include <tbb/parallel_for.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/kd_tree.h"
#include "core/voxel_grid.h"
#include "delio/core/geometry.h"
#include "odometry/tuning.h"
#include "paper/normals.h"

namespace delio::odometry {
namespace {
using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInterval_s = 0.02;  //!< between poses of the trajectory

std::size_t numberOf(Index i) { return static_cast<std::size_t>(i); }

/** A pose of the trajectory between two of its knots. */
struct Between {
    Index knot = 0;    //!< the earlier one
    double share = 0;  //!< 0 there to 1 at the next one
};

/** Poses at equal intervals of time. */
class Knots {
 public:
    explicit Knots(const ScanTrajectory& trajectory)
        : first_s_(trajectory.times_s().front()),
          interval_s_(trajectory.times_s()[1] - first_s_),
          trajectory_(trajectory) {}

    Index size() const { return static_cast<Index>(trajectory_.poses().size()); }
    const ScanTrajectory& trajectory() const { return trajectory_; }
    const Isometry3d& operator[](Index k) const { return trajectory_.poses()[numberOf(k)]; }
    Between between(double time_s) const {
        const double at = (time_s - first_s_) / interval_s_;
        const Index knot = std::clamp<Index>(static_cast<Index>(std::floor(at)), 0, size() - 2);
        return {knot, at - static_cast<double>(knot)};
    }
    double interval_s() const { return interval_s_; }
    /** Six numbers a knot: a rotation vector in the sensor's frame, and a translation. */
    void move(const Eigen::VectorXd& step) {
        auto poses = trajectory_.poses();
        for (std::size_t k = 0; k < poses.size(); ++k) {
            const auto at = static_cast<Index>(6 * k);
            const Matrix3d R = poses[k].linear() * rotationExp(step.segment<3>(at));
            poses[k] = isometry(normalised(R), poses[k].translation() + step.segment<3>(at + 3));
        }
        trajectory_ = ScanTrajectory(trajectory_.times_s(), poses);
    }

 private:
    double first_s_, interval_s_;
    ScanTrajectory trajectory_;
};

/** A point of one scan, and the surface of another one next to it. */
struct Pair {
    Index point = 0, surface = 0;
};

/** Two of the scans: points of the one on surfaces of the other. */
struct ScanPair {
    const TimedScan* from = nullptr;
    const TimedScan* to = nullptr;
    std::size_t toNumber = 0;
    std::vector<Pair> pairs;
    std::vector<Index> nearest = {};  //!< of each point the surface in the last matching; or -1
};

/** Sums of the normal equations. */
struct Sums {
    Eigen::MatrixXd information;
    Eigen::VectorXd gradient;
    double weight = 0, cost = 0;

    explicit Sums(Index unknowns)
        : information(Eigen::MatrixXd::Zero(unknowns, unknowns)),
          gradient(Eigen::VectorXd::Zero(unknowns)) {}
};

Eigen::Matrix3Xf placed(const TimedPoints& points, const PoseTable& poses) {
    Eigen::Matrix3Xf result(3, points.points.cols());
    for (Index i = 0; i < result.cols(); ++i)
        result.col(i) =
            (poses.at(points.times_s[numberOf(i)]) * points.points.col(i)).cast<float>();
    return result;
}

PoseTable tableOf(const ScanTrajectory& trajectory) {
    return {trajectory, trajectory.times_s().front(), trajectory.times_s().back()};
}

/** The surfaces of a scan in the map. */
struct PlacedSurfaces {
    Eigen::Matrix3Xf points;
    std::unique_ptr<KdTree> tree;  //!< of these
};

/** Of the first `count` scans. */
std::vector<PlacedSurfaces> surfacesOf(const std::deque<TimedScan>& scans, std::size_t count,
                                       const PoseTable& poses) {
    std::vector<PlacedSurfaces> surfaces(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        surfaces[i].points = placed(scans[i].surfaces, poses);
        surfaces[i].tree = std::make_unique<KdTree>(surfaces[i].points);
    });
    return surfaces;
}

/** Registration of some scans along one trajectory. */
class Registration {
 public:
    /** Of all scans to each other. */
    Registration(const std::deque<TimedScan>& scans, const ScanTrajectory& start)
        : scans_(scans), knots_(start) {
        for (std::size_t to = 0; to < scans.size(); ++to)
            for (std::size_t from = 0; from < scans.size(); ++from)
                if (from != to) pairs_.push_back({&scans[from], &scans[to], to, {}});
    }
    /** Of the latest scan to the others, which keep their poses and have these surfaces. */
    Registration(const std::deque<TimedScan>& scans, const ScanTrajectory& start,
                 const std::vector<PlacedSurfaces>& others)
        : scans_(scans), knots_(start), others_(&others) {
        const std::size_t last = scans.size() - 1;
        for (std::size_t to = 0; to < last; ++to)
            pairs_.push_back({&scans[last], &scans[to], to, {}});
        firstFree_ = knots_.between(scans[last - 1].last_s).knot + 2;
    }

    const ScanTrajectory& trajectory() const { return knots_.trajectory(); }

    /** Finds the nearest surfaces. */
    void match(double reach) {
        const PoseTable poses = tableOf(trajectory());
        std::vector<PlacedSurfaces> all;
        if (!others_) all = surfacesOf(scans_, scans_.size(), poses);
        const auto& placedSurfaces = others_ ? *others_ : all;
        tbb::parallel_for(std::size_t{0}, pairs_.size(), [&](std::size_t k) {
            auto& pair = pairs_[k];
            pair.pairs.clear();
            const Eigen::Matrix3Xf points = placed(pair.from->points, poses);
            const PlacedSurfaces& surfaces = placedSurfaces[pair.toNumber];
            pair.nearest.resize(numberOf(points.cols()), -1);
            for (Index i = 0; i < points.cols(); ++i) {
                // The surface of the last matching is a bound: few are nearer.
                Index& nearest = pair.nearest[numberOf(i)];
                float squared = static_cast<float>(reach * reach);
                if (nearest >= 0) {
                    const float before =
                        (points.col(i) - surfaces.points.col(nearest)).squaredNorm();
                    if (before < squared)
                        squared = before;
                    else
                        nearest = -1;
                }
                std::uint32_t found = 0;
                if (surfaces.tree->nearestWithin(points.col(i), found, squared))
                    nearest = Index{found};
                if (nearest >= 0) pair.pairs.push_back({i, nearest});
            }
        });
    }

    /** One Gauss-Newton step; its largest part, metres or rad. */
    double improve(double kernel) {
        const PoseTable poses = tableOf(trajectory());
        std::vector<Sums> parts(pairs_.size(), Sums(unknowns()));
        tbb::parallel_for(std::size_t{0}, pairs_.size(),
                          [&](std::size_t k) { add(pairs_[k], poses, kernel, parts[k]); });
        Sums sums(unknowns());
        for (const auto& part : parts) {
            sums.information += part.information;
            sums.gradient += part.gradient;
            sums.weight += part.weight;
            sums.cost += part.cost;
        }
        if (sums.weight == 0) return 0;
        constexpr double kLeast_m2 = 1e-4;
        const double factor =
            plane_tuning::kIndependentRatio / std::max(sums.cost / sums.weight, kLeast_m2);
        sums.information *= factor;
        sums.gradient *= factor;
        addSmoothness(sums);
        // Along an axis that nothing constrains, the trajectory stays as it is.
        sums.information.diagonal().array() += 1;
        const Index kept = 6 * firstUnknown(), free = unknowns() - kept;
        Eigen::VectorXd step = Eigen::VectorXd::Zero(unknowns());
        step.tail(free) =
            -sums.information.bottomRightCorner(free, free).ldlt().solve(sums.gradient.tail(free));
        knots_.move(step);
        return step.lpNorm<Eigen::Infinity>();
    }

    /** Of the latest scan's points on the surfaces of the other scans, and of theirs on its. */
    double inlierRatio() {
        constexpr double kFits_m = 0.1, kReach_m = 0.6;
        match(kReach_m);
        const PoseTable poses = tableOf(trajectory());
        std::size_t fitting = 0, all = 0;
        for (const auto& pair : pairs_) {
            if (pair.from != &scans_.back() && pair.to != &scans_.back()) continue;
            all += pair.from->points.times_s.size();
            for (const auto& one : pair.pairs)
                fitting += std::abs(residualOf(pair, one, poses).distance) < kFits_m ? 1 : 0;
        }
        return all > 0 ? static_cast<double>(fitting) / static_cast<double>(all) : 0;
    }

 private:
    /** Of a point from a surface. */
    struct Residual {
        double distance = 0;
        Vector3d normal, offset;  //!< of the surface; of the point from its centre; map's frame
        Matrix3d fromPoint, fromSurface;  //!< rotations: the map's frame to the sensor's
    };

    Index unknowns() const { return 6 * knots_.size(); }
    /** The first pose stays, or all those of the scans before the latest one. */
    Index firstUnknown() const { return std::max<Index>(firstFree_, 1); }

    static Residual residualOf(const ScanPair& pair, const Pair& one, const PoseTable& poses) {
        const Isometry3d point = poses.at(pair.from->points.times_s[numberOf(one.point)]),
                         surface = poses.at(pair.to->surfaces.times_s[numberOf(one.surface)]);
        Residual residual;
        residual.normal = surface.linear() * pair.to->normals.col(one.surface);
        residual.offset = point * pair.from->points.points.col(one.point) -
                          surface * pair.to->surfaces.points.col(one.surface);
        residual.distance = residual.normal.dot(residual.offset);
        residual.fromPoint = point.linear().transpose();
        residual.fromSurface = surface.linear().transpose();
        return residual;
    }

    /** Geman-McClure's weights. Point and surface move in opposite directions. Only blocks on and
     *  below the diagonal are summed, of the poses that are sought. */
    void add(const ScanPair& pair, const PoseTable& poses, double kernel, Sums& sums) const {
        constexpr double kLeastWeight = 0.01;
        const Index kept = 6 * firstUnknown();
        for (const auto& one : pair.pairs) {
            const Residual residual = residualOf(pair, one, poses);
            const double ratio = residual.distance / kernel,
                         weight = 1 / ((1 + ratio * ratio) * (1 + ratio * ratio));
            if (weight < kLeastWeight) continue;
            const Vector3d p = pair.from->points.points.col(one.point),
                           q = pair.to->surfaces.points.col(one.surface),
                           n = pair.to->normals.col(one.surface);
            Vector6 ofPoint, ofSurface;
            ofPoint << p.cross(residual.fromPoint * residual.normal), residual.normal;
            ofSurface << n.cross(residual.fromSurface * residual.offset) - q.cross(n),
                -residual.normal;
            const Between at = knots_.between(pair.from->points.times_s[numberOf(one.point)]),
                          on = knots_.between(pair.to->surfaces.times_s[numberOf(one.surface)]);
            const std::array<std::pair<Index, Vector6>, 4> rows{
                {{6 * at.knot, (1 - at.share) * ofPoint},
                 {6 * at.knot + 6, at.share * ofPoint},
                 {6 * on.knot, (1 - on.share) * ofSurface},
                 {6 * on.knot + 6, on.share * ofSurface}}};
            for (const auto& [i, row] : rows) {
                if (i < kept) continue;
                const Vector6 weighted = weight * row;
                sums.gradient.segment<6>(i) += residual.distance * weighted;
                for (const auto& [j, other] : rows)
                    if (j >= kept && j <= i)
                        sums.information.block<6, 6>(i, j).noalias() +=
                            weighted * other.transpose();
            }
            sums.weight += weight;
            sums.cost += weight * residual.distance * residual.distance;
        }
    }

    /** The jerk is small: of a rotation about, and of a translation along each axis. */
    void addSmoothness(Sums& sums) const {
        constexpr double kJerk_radps3 = 500, kJerk_mps3 = 250;  // of a hand that swings
        constexpr std::array<double, 4> kThird{-1, 3, -3, 1};   // difference of poses
        const double cube = std::pow(knots_.interval_s(), 3);
        Vector6 information;
        information << Vector3d::Constant(1 / std::pow(kJerk_radps3 * cube, 2)),
            Vector3d::Constant(1 / std::pow(kJerk_mps3 * cube, 2));
        const auto turn = [&](Index k) {
            return rotationLog(knots_[k].linear().transpose() * knots_[k + 1].linear());
        };
        for (Index k = 0; k + 3 < knots_.size(); ++k) {
            Vector6 jerk;
            jerk << turn(k + 2) - 2 * turn(k + 1) + turn(k),
                knots_[k + 3].translation() - 3 * knots_[k + 2].translation() +
                    3 * knots_[k + 1].translation() - knots_[k].translation();
            for (Index a = 0; a < 4; ++a) {
                const double share = kThird[numberOf(a)];
                sums.gradient.segment<6>(6 * (k + a)) += share * information.cwiseProduct(jerk);
                for (Index b = 0; b < 4; ++b)
                    sums.information.block<6, 6>(6 * (k + a), 6 * (k + b)).diagonal() +=
                        share * kThird[numberOf(b)] * information;
            }
        }
    }

    const std::deque<TimedScan>& scans_;
    std::vector<ScanPair> pairs_;
    Knots knots_;
    Index firstFree_ = 0;  //!< knot; 0: all but the first
    const std::vector<PlacedSurfaces>* others_ = nullptr;
};

/** See registerTogether(). */
Together registered(Registration registration, double kernel) {
    constexpr double kLastKernel_m = 0.15, kNarrower = 1.6, kLeastReach_m = 0.6, kMostReach_m = 2.5;
    constexpr unsigned kMatchings = 2, kSteps = 3;
    constexpr double kConverged = 0.01;  // of the kernel
    for (double width = kernel;; width = std::max(width / kNarrower, kLastKernel_m)) {
        for (unsigned matching = 0; matching < kMatchings; ++matching) {
            registration.match(std::clamp(3 * width, kLeastReach_m, kMostReach_m));
            double moved = 0;
            for (unsigned i = 0; i < kSteps; ++i) {
                const double step = registration.improve(width);
                moved = std::max(moved, step);
                if (step < kConverged * width) break;
            }
            if (moved < kConverged * width) break;
        }
        if (width <= kLastKernel_m) break;
    }
    return {registration.trajectory(), registration.inlierRatio()};
}

/** At equal intervals from the first to the last point of the scans. */
std::vector<double> knotTimes(double first_s, double last_s) {
    std::vector<double> times_s;
    for (std::size_t k = 0; k < 3 || times_s.back() < last_s; ++k)
        times_s.push_back(first_s + static_cast<double>(k) * kInterval_s);
    return times_s;
}

ScanTrajectory resampled(const ScanTrajectory& trajectory, double first_s, double last_s) {
    const auto times_s = knotTimes(first_s, last_s);
    std::vector<Isometry3d> poses;
    poses.reserve(times_s.size());
    for (const double time_s : times_s) poses.push_back(trajectory.at(time_s));
    return {times_s, poses};
}

/** How far the motion is off one of constant twist, rad. */
double unevennessOf(const ScanTrajectory& trajectory) {
    const double first_s = trajectory.times_s().front(), last_s = trajectory.times_s().back();
    const Isometry3d& first = trajectory.poses().front();
    const Twist mean = Twist::of(first.inverse() * trajectory.poses().back(), last_s - first_s);
    double most = 0;
    for (std::size_t k = 0; k < trajectory.poses().size(); ++k) {
        const Isometry3d even = first * mean.after(trajectory.times_s()[k] - first_s);
        most = std::max(most, angleOf(even.linear().transpose() * trajectory.poses()[k].linear()));
    }
    return most;
}
}  // namespace

TimedScan timedScanOf(const PointCloud& cloud, double time_s) {
    constexpr double kSpacing_m = 0.5, kSurfaceSpacing_m = 0.25;
    constexpr Index kMostPoints = 1000, kMostSurfaces = 4000, kMostVoxels = 8000;
    TimedScan scan;
    scan.time_s = time_s;
    const auto [least, most] = rangeOf(cloud.times_s);
    scan.first_s = time_s + double{least};
    scan.last_s = time_s + double{most};
    scan.points =
        sampled(timedPoints(cloud, firstsOfVoxels(cloud.points, kSpacing_m)), kMostPoints);
    for (auto& point_s : scan.points.times_s) point_s += time_s;

    NormalsOptions options;
    options.voxel_size = kSurfaceSpacing_m;
    const auto normals = paper::estimateNormals(cloud.points, options, kMostVoxels);
    const Eigen::Matrix3Xf surfaces = sample(normals.points, kMostSurfaces);
    scan.surfaces.points = surfaces.cast<double>();
    scan.normals = sample(normals.directions, kMostSurfaces).cast<double>();
    // At the time of the first point in its voxel.
    const auto firsts = firstsOfVoxels(cloud.points, kSurfaceSpacing_m);
    for (const Index voxel : sample(normals.voxels, kMostSurfaces))
        scan.surfaces.times_s.push_back(time_s +
                                        double{cloud.times_s[numberOf(firsts[numberOf(voxel)])]});
    scan.cloud = cloud;
    return scan;
}

Together registerTogether(const std::deque<TimedScan>& scans, const ScanTrajectory& start,
                          double kernel) {
    return registered(Registration(scans, start), kernel);
}

void ScanWindow::begin(TimedScan scan, const ScanTrajectory& trajectory) {
    scans_.clear();
    inlierRatio_ = 0;
    std::vector<double> times_s = trajectory.times_s();
    for (auto& time : times_s) time += scan.time_s;
    scans_.push_back(std::move(scan));
    trajectory_ =
        resampled({times_s, trajectory.poses()}, scans_.back().first_s, scans_.back().last_s);
}

namespace {
/** Three about each axis, rad/s. */
std::vector<Vector3d> ratesOfTurn() {
    constexpr std::size_t kAll = 27;
    constexpr double kRate_radps = 1.5;
    const auto step = [](std::size_t number) { return static_cast<double>(number % 3) - 1; };
    std::vector<Vector3d> rates;
    for (std::size_t i = 0; i < kAll; ++i)
        rates.push_back(kRate_radps * Vector3d(step(i), step(i / 3), step(i / 9)));
    return rates;
}

/** Of the registrations number 0 to `count` - 1, in parallel: the one of the most inliers. */
template <class Register>
Together bestOf(std::size_t count, const Register& registration) {
    std::vector<Together> found(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { found[i] = registration(i); });
    return *std::max_element(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return a.inlierRatio < b.inlierRatio;
    });
}

/** `trajectory`, of some poses at least, until `last_s` or longer. Its rate of turn is that of the
 *  last three intervals, its acceleration that since the three before. */
ScanTrajectory extended(const ScanTrajectory& trajectory, double last_s, const TurningOn& turning) {
    constexpr std::size_t kIntervals = 3;
    auto times_s = trajectory.times_s();
    auto poses = trajectory.poses();
    const std::size_t last = poses.size() - 1, over = std::min(kIntervals, last / 2);
    const auto mean = [&](std::size_t end) -> Vector3d {
        return rotationLog(poses[end - over].linear().transpose() * poses[end].linear()) /
               static_cast<double>(over);
    };
    const double intervals = static_cast<double>(over);
    const Vector3d acceleration =
        turning.acceleration / intervals * (mean(last) - mean(last - over));
    const Vector3d moved =
        (poses[last].translation() - poses[last - over].translation()) / intervals;
    Vector3d turned = mean(last) + kInterval_s * turning.more + (intervals - 1) / 2 * acceleration;
    while (times_s.back() < last_s) {
        turned += acceleration;
        poses.push_back(isometry(poses.back().linear() * rotationExp(turned),
                                 poses.back().translation() + moved));
        times_s.push_back(times_s.back() + kInterval_s);
    }
    return {times_s, poses};
}

}  // namespace

Together ScanWindow::registerLatest(const std::vector<TurningOn>& turnings) const {
    constexpr double kKernel_m = 1;
    const auto others = surfacesOf(scans_, scans_.size() - 1, tableOf(known_));
    return bestOf(turnings.size(), [&](std::size_t i) {
        const auto start = extended(known_, scans_.back().last_s, turnings[i]);
        return registered(Registration(scans_, start, others), kKernel_m);
    });
}

/** All scans together, from where the latest one was found. */
void ScanWindow::accept(const Together& found) {
    constexpr double kKernel_m = 0.3;
    trajectory_ = registerTogether(scans_, found.trajectory, kKernel_m).trajectory;
    inlierRatio_ = found.inlierRatio;
}

bool ScanWindow::add(const PointCloud& cloud, double time_s) {
    constexpr double kUsual = 0.8, kLeast = 0.3;
    scans_.push_back(timedScanOf(cloud, time_s));
    if (scans_.size() > kMostScans) scans_.pop_front();
    const auto& times_s = trajectory_.times_s();
    std::size_t old = 0;
    while (old + 3 < times_s.size() && times_s[old + 1] < scans_.front().first_s) ++old;
    const auto first = static_cast<std::ptrdiff_t>(old);
    known_ = ScanTrajectory({times_s.begin() + first, times_s.end()},
                            {trajectory_.poses().begin() + first, trajectory_.poses().end()});
    const double usual = inlierRatio_;
    accept(registerLatest({{1, Vector3d::Zero()}, {0, Vector3d::Zero()}}));
    if (inlierRatio_ < kUsual * usual) search();
    return inlierRatio_ > kLeast * usual;
}

bool ScanWindow::search() {
    const double before = inlierRatio_;
    std::vector<TurningOn> turnings;
    for (const Vector3d& more : ratesOfTurn()) turnings.push_back({0, more});
    const Together best = registerLatest(turnings);
    if (best.inlierRatio > before) accept(best);
    return inlierRatio_ > before;
}

bool ScanWindow::addSecond(const PointCloud& cloud, double time_s, const Twist& guess,
                           bool likely) {
    constexpr double kNear_m = 1, kFar_m = 2, kUneven_rad = 1.5 * M_PI / 180, kBetter = 1.1;
    scans_.push_back(timedScanOf(cloud, time_s));
    const auto times_s = knotTimes(scans_.front().first_s, scans_.back().last_s);
    const Isometry3d first = trajectory_.poses().front();
    const auto from = [&](const Twist& twist) {
        return ScanTrajectory::even(times_s, first, twist);
    };
    Together best = registerTogether(scans_, from(guess), kNear_m);
    if (likely && unevennessOf(best.trajectory) < kUneven_rad) return false;
    const auto rates = ratesOfTurn();
    Together turned = bestOf(rates.size(), [&](std::size_t i) {
        Twist twist;
        twist.turning = rates[i];
        return registerTogether(scans_, from(twist), kFar_m);
    });
    if (turned.inlierRatio > best.inlierRatio) best = std::move(turned);
    trajectory_ = best.trajectory;
    const double even = Registration(scans_, from(guess)).inlierRatio();
    return unevennessOf(trajectory_) > kUneven_rad && best.inlierRatio > kBetter * even;
}

void ScanWindow::moveTo(const Isometry3d& pose) {
    const Isometry3d moved = pose * trajectory_.at(scans_.back().time_s).inverse();
    auto poses = trajectory_.poses();
    for (auto& one : poses)
        one = isometry(normalised(moved.linear() * one.linear()), moved * one.translation());
    trajectory_ = {trajectory_.times_s(), poses};
}
}  // namespace delio::odometry
