#include "core/principal_axes.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace delio {
namespace {
/** The largest root of y^3 - 3 y - 2 r, r in [0, 1]: 2 cos(acos(r) / 3), in [sqrt 3, 2]. */
double largestRoot(double r) {
    // Starts with an error of 1e-4 (interpolation); each Newton step squares it.
    double y = 1.732133 + r * (0.330661 + r * (-0.081382 + r * 0.018639));
    for (int i = 0; i < 2; ++i) y -= (y * (y * y - 3) - 2 * r) / (3 * (y * y - 1));
    return y;
}

/** Symmetric, of 3 x 3. */
struct Symmetric {
    double xx, yy, zz, xy, yz, zx;

    explicit Symmetric(const Eigen::Matrix3d& all)
        : xx(all(0, 0)),
          yy(all(1, 1)),
          zz(all(2, 2)),
          xy(all(1, 0)),
          yz(all(2, 1)),
          zx(all(2, 0)) {}

    void addToDiagonal(double value) {
        xx += value;
        yy += value;
        zz += value;
    }
    double squaredNorm() const {
        return xx * xx + yy * yy + zz * zz + 2 * (xy * xy + yz * yz + zx * zx);
    }
    double determinant() const {
        return xx * (yy * zz - yz * yz) + xy * (yz * zx - xy * zz) + zx * (xy * yz - yy * zx);
    }
    Eigen::Vector3d times(const Eigen::Vector3d& v) const {
        return {xx * v.x() + (xy * v.y() + zx * v.z()), xy * v.x() + (yy * v.y() + yz * v.z()),
                zx * v.x() + (yz * v.y() + zz * v.z())};
    }
    /** Null vector (unit, either sign) of a matrix of rank 2. */
    Eigen::Vector3d kernel() const {
        // The cofactors are the products of that vector's coordinates, all times one number.
        const double nxx = yy * zz - yz * yz, nyy = xx * zz - zx * zx, nzz = xx * yy - xy * xy,
                     nxy = yz * zx - xy * zz, nyz = xy * zx - xx * yz, nzx = xy * yz - yy * zx;
        const double x = std::abs(nxx), y = std::abs(nyy), z = std::abs(nzz);
        const Eigen::Vector3d n = x >= y && x >= z ? Eigen::Vector3d(nxx, nxy, nzx)
                                  : y >= z         ? Eigen::Vector3d(nxy, nyy, nyz)
                                                   : Eigen::Vector3d(nzx, nyz, nzz);
        return n / std::sqrt(n.squaredNorm());
    }
};

/** Unit, at a right angle to a unit vector (Duff et al., Building an orthonormal basis, revisited,
 *  2017). */
Eigen::Vector3d across(const Eigen::Vector3d& n) {
    const double sign = std::copysign(1.0, n.z()), a = -1 / (sign + n.z());
    return {1 + sign * n.x() * n.x() * a, sign * n.x() * n.y() * a, -sign * n.x()};
}
}  // namespace

PrincipalAxes principalAxes(const Eigen::Matrix3d& scatter) {
    const Symmetric all(scatter);
    const double mean = (all.xx + all.yy + all.zz) / 3;
    Symmetric rest = all;
    rest.addToDiagonal(-mean);
    const double scale = std::sqrt(rest.squaredNorm() / 6);
    if (!(scale > 0)) return {Eigen::Vector3d::Constant(mean), Eigen::Matrix3d::Identity()};
    // Of the smallest and the largest eigenvalue the one that is farther from the middle one: its
    // axis is known best. The others lie across it.
    const double r = rest.determinant() / (2 * scale * scale * scale);
    const bool isLargest = r >= 0;
    const double root = scale * largestRoot(std::min(std::abs(r), 1.0));
    rest.addToDiagonal(isLargest ? -root : root);
    const Eigen::Vector3d axis = rest.kernel(), u = across(axis), v = axis.cross(u);
    const Eigen::Vector3d alongU = all.times(u);
    const double uu = u.dot(alongU), uv = v.dot(alongU), vv = v.dot(all.times(v));
    const double variance = axis.dot(all.times(axis)), middle = (uu + vv) / 2, half = (uu - vv) / 2,
                 apart = std::sqrt(half * half + uv * uv);
    // Of (uu uv; uv vv) the eigenvector of the larger eigenvalue, the better of two ways to put it.
    Eigen::Vector3d longer = u;
    if (apart > 0) {
        const double alongFirst = half > 0 ? apart + half : uv,
                     alongSecond = half > 0 ? uv : apart - half;
        longer = (alongFirst * u + alongSecond * v) /
                 std::sqrt(alongFirst * alongFirst + alongSecond * alongSecond);
    }
    const Eigen::Vector3d shorter = axis.cross(longer);
    PrincipalAxes result;
    if (isLargest) {
        result.variances << middle - apart, middle + apart, variance;
        result.axes << shorter, longer, axis;
    } else {
        result.variances << variance, middle - apart, middle + apart;
        result.axes << axis, shorter, longer;
    }
    return result;
}

Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& moment) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(moment, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign(1, 1, 1);
    sign[2] = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    return svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
}
}  // namespace delio
