#pragma once
#include <Eigen/Core>

namespace delio {
/** Principal axes of a scatter matrix. */
struct PrincipalAxes {
    Eigen::Vector3d variances;  //!< eigenvalues, ascending
    Eigen::Matrix3d axes;       //!< their eigenvectors
};

/** Solves the cubic by Newton's method for one root and by a square root for the others. Avoids the
 *  C library's sine and arc functions, which differ between processors. @param scatter symmetric */
PrincipalAxes principalAxes(const Eigen::Matrix3d& scatter);

/** Compares eigenvalues of a symmetric matrix without computing them, in a tenth of the time of
 *  principalAxes(). */
class CharacteristicPolynomial {
 public:
    explicit CharacteristicPolynomial(const Eigen::Matrix3d& symmetric) {
        const double xx = symmetric(0, 0), yy = symmetric(1, 1), zz = symmetric(2, 2),
                     xy = symmetric(1, 0), yz = symmetric(2, 1), zx = symmetric(2, 0);
        const double ofX = yy * zz - yz * yz;
        trace_ = xx + yy + zz;
        minors_ = ofX + (xx * zz - zx * zx) + (xx * yy - xy * xy);
        determinant_ = xx * ofX + xy * (yz * zx - xy * zz) + zx * (xy * yz - yy * zx);
    }

    double trace() const { return trace_; }              //!< the eigenvalues' sum
    double minors() const { return minors_; }            //!< of the products of two of them
    double determinant() const { return determinant_; }  //!< their product

    /** How many eigenvalues are larger: Descartes' rule of signs, which is exact where all roots
     *  are real. */
    int above(double value) const {
        const double first = trace_ - 3 * value,
                     second = minors_ - value * (2 * trace_ - 3 * value),
                     third = determinant_ - value * (minors_ - value * (trace_ - value));
        // Of x^3 - first x^2 + second x - third.
        int changes = 0;
        bool isPositive = true;
        for (const double coefficient : {-first, second, -third}) {
            if (coefficient == 0 || (coefficient > 0) == isPositive) continue;
            isPositive = !isPositive;
            ++changes;
        }
        return changes;
    }

 private:
    double trace_, minors_, determinant_;
};

/** argmin over rotations of sum w |n_from - R n_to|^2, given sum w n_from n_to' (Arun, Kabsch). */
Eigen::Matrix3d rotationOf(const Eigen::Matrix3d& moment);
}  // namespace delio
