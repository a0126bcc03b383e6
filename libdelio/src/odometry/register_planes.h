#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/estimates.h"
#include "delio/core/odometry_options.h"
#include "odometry/plane_map.h"

namespace delio::odometry {
/** What is known of a pose (sensor to map) before the planes are asked. */
struct Prior {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map, metres
    double translation = 0;  //!< information along each axis, 1/m^2; 0: nothing is known
    /** Information, 1/rad^2, right tangent (sensor's frame). */
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();

    /** With a standard deviation of the translation along each axis, and the rotation's covariance.
     */
    static Prior of(const Eigen::Isometry3d& pose, double sigma_m,
                    const Eigen::Matrix3d& covariance_rad2) {
        return {pose, 1 / (sigma_m * sigma_m), covariance_rad2.inverse()};
    }
    /** In units of matches whose weights have this variance factor. */
    Prior times(double factor) const { return {pose, factor * translation, factor * rotation}; }
};

/** A scan registered to the map. Of both estimates the frame `from` is the map's and `to` the
 *  sensor's. */
struct PlaneEstimate {
    RotationEstimate rotation;        //!< sensor to map
    TranslationEstimate translation;  //!< in the map's axes
    /** Inlier ratio: of the points in voxels with a plane those that lie on it, 0 to 1. */
    double inlierRatio = 0;
    /** Along which the planes constrain the translation least: a unit vector of the map's axes. */
    Eigen::Vector3d weakestAxis = Eigen::Vector3d::UnitX();
    /** Over how many sectors about the sensor the planes that constrain it are spread: see
     *  spreadOf(). */
    double weakestSpread = 0;
    /** The planes alone constrain the translation along every axis. */
    bool isByPlanes = false;
    bool valid = false;  //!< false: too few correspondences; it is the prediction

    /** Sensor to map. */
    Eigen::Isometry3d pose() const { return isometry(rotation.rotation, translation.translation); }
};

/** The prediction (sensor to map), where there is nothing to register: not valid, with the motion
 *  model's standard deviations, times `growth`. */
PlaneEstimate predictedEstimate(const Eigen::Isometry3d& pose,
                                const PlaneRegistrationOptions& options, double growth = 1);

/** What the motion model knows: the prediction (sensor to map), off by prior_sigma. */
Prior priorOf(const Eigen::Isometry3d& predicted, const PlaneRegistrationOptions& options);

/** Rotation from translation-free residuals, then translation alone, with new correspondences each
 *  time, while the kernel narrows from `kernel` (metres) to last_kernel: from the prior's pose to
 *  convergence. Planes and prior are fused by their information. An axis is unobserved where the
 *  planes, which have to find the rotation, too, have no more information than the prior, after
 *  that of errors of the normals is subtracted. */
PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Prior& prior, double kernel,
                               const PlaneRegistrationOptions& options);

/** The same from another pose than the prior's (sensor to map): nearer to where it leads. */
PlaneEstimate registerToPlanes(const PlaneMap& map, const Eigen::Matrix3Xd& points,
                               const Prior& prior, const Eigen::Isometry3d& start, double kernel,
                               const PlaneRegistrationOptions& options);

/** A correspondence: a point of a scan, and the plane of the map that it lies next to. */
struct Correspondence {
    Eigen::Vector3d point;   //!< metres, the sensor's frame
    Eigen::Vector3d normal;  //!< unit, the map's frame
    Eigen::Vector3d mean;    //!< a point of the plane, metres, the map's frame
    double weight = 0;       //!< 1/m^2: robust weight over variance
    double tilt = 0;         //!< rad^2: how uncertain the normal's direction is
    std::size_t index = 0;   //!< of the point in the scan

    /** Distance to the plane of the point at pose (R, t), metres, signed. */
    double residual(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) const {
        return normal.dot(R * point + t - mean);
    }
};
/** Of one scan, in the order of its points. */
using Correspondences = std::vector<Correspondence>;

/** Finds them for one scan, over and over: most points stay in their voxels from one pose to the
 *  next. */
class Matcher {
 public:
    /** Keeps references to the map, which must not change, and to the points (metres, the sensor's
     *  frame). `point_sigma`: of a measured point, metres. Not for several threads at once. */
    Matcher(const PlaneMap& map, const Eigen::Matrix3Xd& points, double point_sigma);

    /** Points next to a plane of the map at `pose` (sensor to map), with robust weights
     *  (Geman-McClure of width `kernel`, metres) over the variance of plane and point. In the order
     *  of the points. */
    Correspondences at(const Eigen::Isometry3d& pose, double kernel);

    /** The same for points that placeOne(i) places (metres, the map's frame), summed up at once:
     *  addOne(i, placed, plane, weight, sum) for each point i next to a plane. The same bytes for
     *  any number of threads.
     *  @tparam Sum is nothing where it is made, and has += */
    template <typename Sum, typename PlaceOne, typename AddOne>
    Sum sumAt(const PlaceOne& placeOne, double kernel, const AddOne& addOne) {
        std::vector<Sum> sums(blocks());
        tbb::parallel_for(std::size_t{0}, blocks(), [&](std::size_t block) {
            Placed placed(3, static_cast<Eigen::Index>(endOf(block) - block * kBlock));
            for (std::size_t i = block * kBlock; i < endOf(block); ++i)
                placed.col(static_cast<Eigen::Index>(i - block * kBlock)) = placeOne(i);
            findPlanes(block, placed);
            forMatches(block, placed, kernel,
                       [&](std::size_t i, const Eigen::Vector3d& at, const Plane& plane,
                           double weight) { addOne(i, at, plane, weight, sums[block]); });
        });
        Sum all{};
        for (const Sum& sum : sums) all += sum;
        return all;
    }

    /** How well those points that fall into voxels with a plane lie on it at `pose`, 0 to 1. What
     *  is seen for the first time does not count. */
    double shareAt(const Eigen::Isometry3d& pose, double kernel);

 private:
    /** Points farther from a plane than so many kernel widths do not belong to it. */
    static constexpr double kReach = 3;
    /** So many points, one after the other, are looked up together. */
    static constexpr std::size_t kBlock = 512;
    std::size_t blocks() const { return (latest_.size() + kBlock - 1) / kBlock; }
    std::size_t endOf(std::size_t block) const {
        return std::min(latest_.size(), (block + 1) * kBlock);
    }
    /** Of a block's points, metres, the map's frame. */
    using Placed = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kBlock>;
    Placed placedBy(const Eigen::Isometry3d& pose, std::size_t block) const;
    void findPlanes(std::size_t block, const Placed& placed);
    /** visit(i, placed, plane, weight) for each of a block's points that is next to a plane. */
    template <typename Visit>
    void forMatches(std::size_t block, const Placed& placed, double kernel,
                    const Visit& visit) const {
        const double perKernel2 = 1 / (kernel * kernel), point = point_sigma_ * point_sigma_;
        for (std::size_t i = block * kBlock; i < endOf(block); ++i) {
            const Plane* plane = latest_[i].plane;
            if (!plane) continue;
            const Eigen::Vector3d at = placed.col(static_cast<Eigen::Index>(i - block * kBlock)),
                                  along = plane->along(at);
            if (std::abs(along[0]) > kReach * kernel) continue;
            const double inverse = 1 + along[0] * along[0] * perKernel2;
            visit(i, at, *plane, 1 / (inverse * inverse * (plane->varianceAt(along) + point)));
        }
    }

    const PlaneMap& map_;
    const Eigen::Matrix3Xd& points_;
    double point_sigma_;
    struct Place {
        std::uint64_t voxel = ~std::uint64_t{0};  //!< that no point is in
        const Plane* plane = nullptr;
    };
    std::vector<Place> latest_;  //!< of the points
};

/** Finds the correspondences of points at a pose, with a kernel of that width (metres). */
using FindMatches = std::function<Correspondences(const Eigen::Isometry3d& pose, double kernel)>;

/** registerToPlanes() for points that are compared with several maps: `inlierRatio` stays 0. */
PlaneEstimate registerByMatches(const FindMatches& find, const Prior& prior, double kernel,
                                const PlaneRegistrationOptions& options);

/** What plane residuals say of the rotation alone. */
struct PlaneRotation {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();  //!< rad; R exp(step) is the better rotation
    /** 1/rad^2, right tangent (sensor's frame): the Schur complement H_rr - H_rt H_tt^-1 H_tr,
     *  without the prior. */
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    double weight = 0;  //!< sum of the matches' weights
};

/** The rotation from translation-free residuals: n . (R p + t - q) is linear in t, so with N the
 *  stack of weighted normals the projection I - N (N'N)^-1 N' takes t out of all residuals, and
 *  the rest has a minimum over R alone. One Gauss-Newton step. The prior (in units of the weights)
 * is fused by its information. There is no step about an unconstrained axis. */
PlaneRotation rotationFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                                 const Prior& prior = {});

/** What plane residuals say of the translation, the rotation known. */
struct PlaneTranslation {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();         //!< m, the map's frame
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  //!< 1/m^2, the map's frame: H_tt
    /** What of it the normals' own errors alone would give. */
    Eigen::Matrix3d pretended = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();  //!< H_tr, 1/(m rad): t against w
    double weight = 0;                                //!< sum of the matches' weights

    /** The sums over the matches of both; the step stays. */
    void operator+=(const PlaneTranslation& other) {
        information += other.information;
        pretended += other.pretended;
        mixed += other.mixed;
        weight += other.weight;
    }
};

/** The closed form: the least-squares translation of the unrotated scan. The prior (in units of
 *  the weights) is fused by its information. There is no step along an unconstrained axis. */
PlaneTranslation translationFromPlanes(const Correspondences& matches,
                                       const Eigen::Isometry3d& pose, const Prior& prior = {});

/** Its step alone: all that is asked for until the last one. */
Eigen::Vector3d stepFromPlanes(const Correspondences& matches, const Eigen::Isometry3d& pose,
                               const Prior& prior = {});

/** The normal equations of a Gauss-Newton step over N unknowns: sums over weighted residuals. */
template <int N>
struct NormalEquations {
    using Vector = Eigen::Matrix<double, N, 1>;       //!< a gradient, or a row of the Jacobian
    using Information = Eigen::Matrix<double, N, N>;  //!< J' W J

    Information information = Information::Zero();  //!< J' W J
    Vector gradient = Vector::Zero();               //!< J' W r
    double weight = 0;                              //!< sum of the weights
    double cost = 0;                                //!< r' W r

    /** One residual, with its row of the Jacobian. */
    void add(const Vector& jacobian, double residual, double w) {
        const Vector weighted = w * jacobian;
        information.noalias() += weighted * jacobian.transpose();
        gradient += residual * weighted;
        weight += w;
        cost += w * residual * residual;
    }
    /** The residuals of both. */
    void operator+=(const NormalEquations& other) {
        information += other.information;
        gradient += other.gradient;
        weight += other.weight;
        cost += other.cost;
    }
};

/** addOne(match, sum) for each correspondence. Parts of them are summed side by side and come
 *  together as their number alone says: the same bytes for any number of threads.
 *  @tparam Sum is nothing where it is made, and has += */
template <typename Sum, typename AddOne>
Sum sumOver(const Correspondences& matches, const AddOne& addOne) {
    using Range = tbb::blocked_range<std::size_t>;
    constexpr std::size_t kPart = 512;
    return tbb::parallel_deterministic_reduce(
        Range(0, matches.size(), kPart), Sum(),
        [&](const Range& range, Sum sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) addOne(matches[i], sum);
            return sum;
        },
        [](Sum sum, const Sum& other) {
            sum += other;
            return sum;
        });
}
}  // namespace delio::odometry
