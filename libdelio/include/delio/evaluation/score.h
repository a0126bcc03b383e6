#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <string>
#include <vector>

#include "delio/evaluation/kitti_metric.h"

namespace delio::evaluation {
/** The figures of one estimate on one sequence. NaN: not available, printed as '-'. */
struct ReportRow {
    std::string name;      //!< of the estimate
    std::string sequence;  //!< "avg" in a row of averages
    double length_m = 0;   //!< of the reference's path
    KittiErrors kitti;     //!< over KITTI's segments
    double ape_m = 0;      //!< RMSE after rigid alignment
    double rpe_m = 0;      //!< RMSE
    double rpe_deg = 0;    //!< RMSE
};

/** Scores an estimate pose by pose: every metric of a row. */
ReportRow score(const std::vector<Eigen::Isometry3d>& reference,
                const std::vector<Eigen::Isometry3d>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta);

/** The row "avg" as papers on KITTI give it: the plain mean of the sequences' errors, however long
 *  they are; lengths and counts of segments are summed. A figure that a sequence does not have is
 *  left out of its mean. `rows` is not empty. */
ReportRow averageOf(const std::vector<ReportRow>& rows);
}  // namespace delio::evaluation
