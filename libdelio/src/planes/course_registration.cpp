#include "delio/planes/course_registration.h"

#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "delio/core/pose_table.h"
#include "delio/planes/correspondence.h"
#include "sum_over.h"

namespace delio::planes {
namespace {
/** The polynomial's coefficients, a rotation vector and a translation each: the pose at the stamp,
 *  and what acceleration and jerk add to the way there and beyond. */
constexpr Eigen::Index kDegree = 3;
using Coefficients = Eigen::Matrix<double, 6 * kDegree, 1>;
using Information = Eigen::Matrix<double, 6 * kDegree, 6 * kDegree>;

/** What each coefficient counts at `time_s` from the stamp: nothing where the pose is known; the
 *  latter two nothing at the stamp either. */
Eigen::Matrix<double, kDegree, 1> sharesAt(double time_s, double since_s) {
    const double way = 1 + time_s / since_s;
    return {way, way * (way - 1), way * (way - 1) * (way + 1)};
}

/** 1 over the variance of each. */
Coefficients informationOf(const CoursePrior& prior) {
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

struct Sums {
    Information information = Information::Zero();
    Coefficients gradient = Coefficients::Zero();
    double squares = 0;

    void operator+=(const Sums& other) {
        information += other.information;
        gradient += other.gradient;
        squares += other.squares;
    }
};

/** Of points that are in the map's frame already. */
Sums sumsOf(const Correspondences& matches, const TimedPoints& scan, const PoseTable& poses,
            double since_s) {
    return sumOver<Sums>(matches, [&](const Correspondence& match, Sums& sum) {
        const double time_s = scan.times_s[match.index],
                     residual = match.normal.dot(match.point - match.mean);
        const Eigen::Vector3d point = scan.points.col(static_cast<Eigen::Index>(match.index));
        Vector6 both;
        both << point.cross(poses.at(time_s).linear().transpose() * match.normal), match.normal;
        const auto shares = sharesAt(time_s, since_s);
        Coefficients all;
        for (Eigen::Index k = 0; k < kDegree; ++k) all.segment<6>(6 * k) = shares[k] * both;
        const Coefficients weighted = match.weight * all;
        sum.information.noalias() += weighted * all.transpose();
        sum.gradient += residual * weighted;
        sum.squares += match.weight * residual * residual;
    });
}

/** In the map's frame. */
void place(const TimedPoints& scan, const PoseTable& poses, Eigen::Matrix3Xd& placed) {
    tbb::parallel_for(std::size_t{0}, scan.times_s.size(), [&](std::size_t i) {
        const auto k = static_cast<Eigen::Index>(i);
        placed.col(k) = poses.at(scan.times_s[i]) * scan.points.col(k);
    });
}

Course bent(const Course& course, const Coefficients& step, double since_s) {
    auto poses = course.poses();
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto shares = sharesAt(course.times_s()[i], since_s);
        Vector6 move = Vector6::Zero();
        for (Eigen::Index k = 0; k < kDegree; ++k) move += shares[k] * step.segment<6>(6 * k);
        const Eigen::Matrix3d R = poses[i].linear() * rotationExp(move.head<3>());
        poses[i] = isometry(normalised(R), poses[i].translation() + move.tail<3>());
    }
    return {course.times_s(), poses};
}
}  // namespace

Course registerCourse(const PlaneMap& map, const TimedPoints& scan, const Course& course,
                      double since_s, const CoursePrior& prior, double kernel,
                      const PlaneRegistrationOptions& options) {
    constexpr unsigned kIterations = 6;  // with one kernel
    constexpr double kConverged = 1e-4, kRough = 1e-3, kLeastFactor = 0.01;
    if (scan.times_s.empty()) return course;
    const auto [least, most] = std::minmax_element(scan.times_s.begin(), scan.times_s.end());
    const Coefficients known = informationOf(prior);
    Eigen::Matrix3Xd placed(3, scan.points.cols());
    Matcher matcher(map, placed, options.point_sigma);
    Course now = course;
    Coefficients sinceStart = Coefficients::Zero();
    for (double width = std::max(kernel, options.last_kernel);;
         width = std::max(width / 2, options.last_kernel)) {
        for (unsigned i = 0; i < kIterations; ++i) {
            const PoseTable poses(now, *least, *most);
            place(scan, poses, placed);
            const auto matches = matcher.at(Eigen::Isometry3d::Identity(), width);
            if (matches.size() < options.min_matches) return course;
            Sums sums = sumsOf(matches, scan, poses, since_s);
            // As in registerToPlanes(): points of one surface err together.
            const double factor =
                std::max(sums.squares / static_cast<double>(matches.size()), kLeastFactor) /
                options.independent_share;
            sums.information.diagonal() += factor * known;
            sums.gradient += factor * known.cwiseProduct(sinceStart);
            const Coefficients step = -sums.information.ldlt().solve(sums.gradient);
            now = bent(now, step, since_s);
            sinceStart += step;
            if (step.norm() < (width > options.last_kernel ? kRough : kConverged)) break;
        }
        if (width <= options.last_kernel) return now;
    }
}
}  // namespace delio::planes
