#pragma once
#include <iosfwd>
#include <vector>

#include "delio/evaluation/score.h"

namespace delio::evaluation {
/** name sequence length_m segments t_percent r_deg_per_100m ape_m rpe_m rpe_deg */
void writeMetricsTsv(const std::vector<ReportRow>& rows, std::ostream& out);

/** name sequence segment_length_m segments t_percent r_deg_per_100m: the KITTI errors by length of
 *  the segments. */
void writeLengthsTsv(const std::vector<ReportRow>& rows, std::ostream& out);

/** The figures of writeMetricsTsv() for people to read. */
void writeTable(const std::vector<ReportRow>& rows, std::ostream& out);
}  // namespace delio::evaluation
