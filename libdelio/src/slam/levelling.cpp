#include "slam/levelling.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/percentile.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"

namespace delio {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Poses = std::vector<Isometry3d>;

namespace {
constexpr double kGravity_mps2 = 9.81;
constexpr unsigned kRounds = 3;

double medianOf(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return percentileOf(values, 50);
}

/** Some seconds of a drive. */
struct Stretch {
    std::size_t middle = 0;              //!< pose
    Vector3d up = Vector3d::Zero();      //!< specific force without the motion, map's axes, m/s^2
    Matrix3d turned = Matrix3d::Zero();  //!< mean rotation from the IMU's axes to the map's
};

/** From poses `first` to `last`: in the map's axes, the integrated force less the way is
 *  c0 + c1 t + up t^2 / 2. */
Stretch stretchOf(const Poses& poses, const ForcesOnTrack& track, double scale, std::size_t first,
                  std::size_t last) {
    const auto count = static_cast<Eigen::Index>(last - first + 1);
    Eigen::MatrixX3d times(count, 3), rest(count, 3);
    Vector3d velocity = Vector3d::Zero(), way = velocity;
    Stretch stretch;
    stretch.middle = (first + last) / 2;
    double time_s = 0;
    for (std::size_t i = first; i <= last; ++i) {
        const auto row = static_cast<Eigen::Index>(i - first);
        const Matrix3d turned = poses[i].linear() * track.mounts[i];
        times.row(row) << 1, time_s, time_s * time_s / 2;
        rest.row(row) = way - (poses[i].translation() - poses[first].translation());
        stretch.turned += turned / static_cast<double>(count);
        if (i == last) break;
        const ForceBetween& force = *track.forces[i];
        way += velocity * force.duration_s + scale * (turned * force.twice);
        velocity += scale * (turned * force.once);
        time_s += force.duration_s;
    }
    stretch.up = times.colPivHouseholderQr().solve(rest).row(2).transpose();
    return stretch;
}

std::vector<Stretch> stretchesOf(const Poses& poses, const ForcesOnTrack& track, double scale) {
    constexpr double kLength_s = 4;
    std::vector<Stretch> stretches;
    for (std::size_t first = 0, last = 0; last < poses.size(); ++last) {
        const bool goesOn = track.usable[last] && (last == first || track.forces[last - 1]);
        if (!goesOn) first = track.usable[last] ? last : last + 1;
        if (first >= last || track.stamps_s[last] - track.stamps_s[first] < kLength_s) continue;
        stretches.push_back(stretchOf(poses, track, scale, first, last));
        first = last;
    }
    return stretches;
}

/** From the accelerometer's unit to m/s^2; 0: there is no gravity in what it measures. */
double scaleOf(const ForcesOnTrack& track) {
    constexpr double kNear = 0.15;
    std::vector<double> strengths;
    for (const auto& force : track.forces)
        if (force) strengths.push_back(force->once.norm() / force->duration_s);
    if (strengths.empty()) return 0;
    const double usual = medianOf(std::move(strengths));
    if (std::abs(usual / kGravity_mps2 - 1) < kNear) return 1;
    return std::abs(usual - 1) < kNear ? kGravity_mps2 : 0;  // in g
}

/** The same for all stretches: up = gravity + turned * bias + noise. */
struct Fit {
    Vector3d gravity = Vector3d::Zero();  //!< upwards, map's axes, m/s^2
    Vector3d bias = Vector3d::Zero();     //!< of the accelerometer, IMU's axes, m/s^2
    double sigma_rad = 0;                 //!< of the vertical, about the worse horizontal axis

    Vector3d upAt(const Stretch& stretch) const { return stretch.up - stretch.turned * bias; }
};

/** Least squares, repeated with weights (Cauchy). A bias that the drive does not show is 0. */
Fit fitOf(const std::vector<Stretch>& stretches) {
    constexpr double kBias_mps2 = 0.1, kLeast_mps2 = 0.01;
    std::vector<double> weights(stretches.size(), 1);
    Fit fit;
    for (unsigned round = 0; round < 2 * kRounds; ++round) {
        Matrix6 information = Matrix6::Zero();
        Vector6 right = Vector6::Zero();
        for (std::size_t i = 0; i < stretches.size(); ++i) {
            Eigen::Matrix<double, 3, 6> J;
            J << Matrix3d::Identity(), stretches[i].turned;
            const Eigen::Matrix<double, 6, 3> weighted = weights[i] * J.transpose();
            information += weighted * J;
            right += weighted * stretches[i].up;
        }
        std::vector<double> errors;
        const auto solve = [&](double noise_mps2) {
            Matrix6 held = information;
            held.diagonal().tail<3>().array() += std::pow(noise_mps2 / kBias_mps2, 2);
            const Eigen::LDLT<Matrix6> factors(held);
            const Vector6 x = factors.solve(right);
            fit.gravity = x.head<3>();
            fit.bias = x.tail<3>();
            errors.clear();
            for (const auto& stretch : stretches)
                errors.push_back((fit.upAt(stretch) - fit.gravity).norm());
            const Matrix3d covariance =
                noise_mps2 * noise_mps2 *
                factors.solve(Matrix6::Identity().eval()).topLeftCorner<3, 3>();
            const Vector3d up = fit.gravity.normalized();
            const Matrix3d level = Matrix3d::Identity() - up * up.transpose();
            const Eigen::SelfAdjointEigenSolver<Matrix3d> spread(level * covariance * level);
            fit.sigma_rad = std::sqrt(std::max(0.0, spread.eigenvalues()[2])) / fit.gravity.norm();
        };
        solve(kLeast_mps2);
        const double noise_mps2 = std::max(kLeast_mps2, medianOf(errors));
        solve(noise_mps2);
        for (std::size_t i = 0; i < stretches.size(); ++i)
            weights[i] = 1 / (1 + std::pow(errors[i] / (2 * noise_mps2), 2));
    }
    return fit;
}

Matrix3d rotationBetween(const Vector3d& from, const Vector3d& to) {
    return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

/** Standard deviation of an angle between directions, rad, by its median. */
double spreadOf(std::vector<double> angles) {
    constexpr double kMedianOf2 = 1.1774;  // of the norm of two standard normal numbers
    return medianOf(std::move(angles)) / kMedianOf2;
}

/** How closely a stretch agrees with the two about it: standard deviation of its tilt, rad. A drift
 *  that goes on does not count. Infinite where there are too few. */
double noiseOf(const std::vector<Stretch>& stretches, const Fit& fit) {
    constexpr double kLeast_rad = 0.05 * M_PI / 180;
    constexpr std::size_t kFewest = 5;
    if (stretches.size() < kFewest) return std::numeric_limits<double>::infinity();
    std::vector<double> bends;
    for (std::size_t i = 1; i + 1 < stretches.size(); ++i) {
        const Vector3d around = (fit.upAt(stretches[i - 1]) + fit.upAt(stretches[i + 1])) / 2;
        bends.push_back(angleOf(rotationBetween(fit.upAt(stretches[i]), around)));
    }
    return std::max(kLeast_rad, spreadOf(std::move(bends)) / std::sqrt(1.5));
}

/** The poses' tilt drifts clearly more than stretches scatter. */
bool drifts(const std::vector<Stretch>& stretches, const Fit& fit) {
    constexpr double kClearly = 2;
    std::vector<double> offsets;
    for (const auto& stretch : stretches)
        offsets.push_back(angleOf(rotationBetween(fit.upAt(stretch), fit.gravity)));
    return spreadOf(std::move(offsets)) > kClearly * noiseOf(stretches, fit);
}

/** Standard deviation of the tilt by one stretch, rad. The poses of an unusual one are off, and
 * then the strength of gravity is off by about as much as its direction. */
double sigmaOf(const Stretch& stretch, const Fit& fit, double usual_rad) {
    const double strength = fit.upAt(stretch).norm() / fit.gravity.norm();
    constexpr double kCaution = 3;
    return std::hypot(usual_rad, kCaution * (strength - 1));
}

/** The poses with their tilts held: node 0 is a level frame, node i+1 is pose i. */
Poses tilted(const graph::PoseGraph& drive, const Poses& poses,
             const std::vector<Stretch>& stretches, const Fit& fit,
             const graph::PoseGraphOptions& options) {
    constexpr double kFree_m = 1e3, kFree_rad = 30, kHeld_m = 0.1, kHeld_rad = 0.01;
    const Matrix3d level = rotationBetween(fit.gravity, Vector3d::UnitZ());
    const double usual_rad = noiseOf(stretches, fit);
    graph::PoseGraph graph;
    graph.addNode(Isometry3d::Identity());
    for (const auto& pose : poses) graph.addNode(isometry(level, Vector3d::Zero()) * pose);
    for (std::size_t i = 0; i < drive.edges().size(); ++i) {
        const auto& edge = drive.edges()[i];
        graph.addEdge(edge.from + 1, edge.to + 1, edge.increment.pose, drive.information(i));
    }
    bool isFirst = true;  // it holds place and heading
    for (const auto& stretch : stretches) {
        const Isometry3d pose = graph.poses()[stretch.middle + 1];
        const Matrix3d tilt = rotationBetween(level * fit.upAt(stretch), Vector3d::UnitZ());
        const double place_m = isFirst ? kHeld_m : kFree_m,
                     yaw_rad = isFirst ? kHeld_rad : kFree_rad;
        const double sigma_rad = sigmaOf(stretch, fit, usual_rad);
        const Vector3d sigmas(sigma_rad, sigma_rad, yaw_rad);
        Matrix6 information = Matrix6::Zero();
        information.topLeftCorner<3, 3>().diagonal().array() = 1 / (place_m * place_m);
        information.bottomRightCorner<3, 3>() = pose.linear().transpose() *
                                                sigmas.cwiseAbs2().cwiseInverse().asDiagonal() *
                                                pose.linear();
        information = (information + information.transpose()).eval() / 2;
        graph.addEdge(0, stretch.middle + 1, isometry(tilt * pose.linear(), pose.translation()),
                      information);
        isFirst = false;
    }
    graph.optimise(options);
    const Isometry3d toMap = poses.front() * graph.poses()[1].inverse();
    Poses moved{poses.front()};
    for (std::size_t i = 2; i < graph.poses().size(); ++i)
        moved.push_back(toMap * graph.poses()[i]);
    return moved;
}
}  // namespace

Levelled levelled(const graph::PoseGraph& graph, const ForcesOnTrack& track,
                  const graph::PoseGraphOptions* options) {
    Levelled found;
    found.graph = graph;
    const double scale = scaleOf(track);
    if (scale == 0) {
        found.vertical.refusal = "the IMU's accelerations do not show gravity";
        return found;
    }
    Poses poses = graph.poses();
    for (unsigned round = 0;; ++round) {
        const auto stretches = stretchesOf(poses, track, scale);
        if (stretches.empty()) {
            found.vertical.refusal = "no four seconds with accelerations and registered scans";
            return found;
        }
        const Fit fit = fitOf(stretches);
        found.vertical.up = fit.gravity.normalized();
        found.vertical.sigma_rad = fit.sigma_rad;
        found.vertical.bias_mps2 = fit.bias;
        found.vertical.stretches = stretches.size();
        if (!options || round == kRounds || (round == 0 && !drifts(stretches, fit))) break;
        poses = tilted(graph, poses, stretches, fit, *options);
        found.vertical.holdsTilt = true;
    }
    found.graph = graph.withPoses(poses);
    return found;
}
}  // namespace delio
