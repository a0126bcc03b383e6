#pragma once
#include <Eigen/Core>
#include <algorithm>

namespace delio::scan {
/** At most `most` of the columns, evenly over their order: of a scan the same share all around. */
template <typename Columns>
Columns sample(const Columns& columns, Eigen::Index most) {
    const Eigen::Index stride = std::max<Eigen::Index>(1, (columns.cols() + most - 1) / most);
    Columns result(columns.rows(), (columns.cols() + stride - 1) / stride);
    for (Eigen::Index i = 0; i < result.cols(); ++i) result.col(i) = columns.col(i * stride);
    return result;
}
}  // namespace delio::scan
