#pragma once
#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

#include "delio/evaluation/kitti_metric.h"

namespace delio::evaluation {
/** The figures of one estimate on one sequence. NaN: not available, printed as '-'. */
struct ReportRow {
    std::string name;      //!< of the estimate
    std::string sequence;  //!< "avg" in a row of averages
    double length_m = 0;   //!< of the reference's path
    KittiErrors kitti;
    double ape_m = 0;    //!< RMSE after rigid alignment
    double rpe_m = 0;    //!< RMSE
    double rpe_deg = 0;  //!< RMSE
};

/** Scores an estimate pose by pose: every metric of a row. */
ReportRow score(const std::vector<mrpt::poses::CPose3D>& reference,
                const std::vector<mrpt::poses::CPose3D>& estimate,
                const std::vector<double>& lengths_m, std::size_t delta);

/** The row "avg" as papers on KITTI give it: the plain mean of the sequences' errors, however long
 *  they are; lengths and counts of segments are summed. A figure that a sequence does not have is
 *  left out of its mean. `rows` is not empty. */
ReportRow averageOf(const std::vector<ReportRow>& rows);

/** name sequence length_m segments t_percent r_deg_per_100m ape_m rpe_m rpe_deg */
void writeMetricsTsv(const std::vector<ReportRow>& rows, std::ostream& out);

/** name sequence segment_length_m segments t_percent r_deg_per_100m: the KITTI errors by length of
 *  the segments. */
void writeLengthsTsv(const std::vector<ReportRow>& rows, std::ostream& out);

/** The figures of writeMetricsTsv() for people to read. */
void writeTable(const std::vector<ReportRow>& rows, std::ostream& out);
}  // namespace delio::evaluation
