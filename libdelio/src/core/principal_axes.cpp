#include "principal_axes.h"

#include <Eigen/Eigenvalues>
#include <limits>

#include "portable_math.h"

namespace delio {
namespace {
/** A double for which Eigen finds portable functions. */
class Real {
 public:
    Real() = default;
    Real(double value) : value_(value) {}
    explicit operator double() const { return value_; }

    friend Real operator+(Real a, Real b) { return a.value_ + b.value_; }
    friend Real operator-(Real a, Real b) { return a.value_ - b.value_; }
    friend Real operator*(Real a, Real b) { return a.value_ * b.value_; }
    friend Real operator/(Real a, Real b) { return a.value_ / b.value_; }
    Real& operator+=(Real b) { return *this = *this + b; }
    Real& operator-=(Real b) { return *this = *this - b; }
    Real& operator*=(Real b) { return *this = *this * b; }
    Real& operator/=(Real b) { return *this = *this / b; }
    friend bool operator<(Real a, Real b) { return a.value_ < b.value_; }
    friend bool operator>(Real a, Real b) { return a.value_ > b.value_; }
    friend bool operator<=(Real a, Real b) { return a.value_ <= b.value_; }

    friend Real abs(Real a) { return std::abs(a.value_); }
    friend Real sqrt(Real a) { return std::sqrt(a.value_); }
    friend Real sin(Real a) { return portable::sin(a.value_); }
    friend Real cos(Real a) { return portable::cos(a.value_); }
    friend Real atan2(Real y, Real x) { return portable::atan2(y.value_, x.value_); }

 private:
    double value_ = 0;
};
}  // namespace
}  // namespace delio

template <>
struct Eigen::NumTraits<delio::Real> : Eigen::NumTraits<double> {
    using Real = delio::Real;
    using NonInteger = delio::Real;
    using Nested = delio::Real;
    using Literal = delio::Real;
};

namespace delio {
PrincipalAxes principalAxes(const Eigen::Matrix3d& scatter) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Real, 3, 3>> solver;
    solver.computeDirect(scatter.cast<Real>());
    return {solver.eigenvalues().cast<double>(), solver.eigenvectors().cast<double>()};
}
}  // namespace delio
