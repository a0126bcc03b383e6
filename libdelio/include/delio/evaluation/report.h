#pragma once
#include <iosfwd>
#include <string>
#include <vector>

#include "delio/evaluation/comparison.h"

namespace delio::evaluation {
/** name sequence length_m segments t_percent r_deg_per_100m ape_m rpe_m rpe_deg */
void writeMetricsTsv(const std::vector<ReportRow>& rows, std::ostream& out);

/** name sequence segment_length_m segments t_percent r_deg_per_100m: the KITTI errors by length of
 *  the segments. */
void writeLengthsTsv(const std::vector<ReportRow>& rows, std::ostream& out);

/** The values of writeMetricsTsv() as a table for people. */
void writeTable(const std::vector<ReportRow>& rows, std::ostream& out);

/** Header of a report. */
struct ReportNotes {
    std::string program;    //!< name and version
    std::string lengths;    //!< of the segments, metres
    std::size_t delta = 1;  //!< poses that the relative error (RPE) spans
};

/** Writes metrics.tsv, lengths.tsv, report.html and plots/ (SVG, PNG, data and gnuplot scripts)
 *  into `folder`, which is created if needed; other files in it are kept. The page embeds its
 *  pictures and opens without a network. Nothing is replaced before everything is written: Error
 *  where that fails, gnuplot is not installed, or another program writes there. While the old
 *  report is being replaced, or after a kill in between, there is no report.html. `rows`: those of
 *  the comparisons, and of averages ("avg"), in the order of the TSV. */
void writeReportFolder(const std::vector<Comparison>& comparisons,
                       const std::vector<ReportRow>& rows, const ReportNotes& notes,
                       const std::string& folder);

/** What writeReportFolder() replaces in `folder`. */
std::vector<std::string> reportFiles(const std::string& folder);
}  // namespace delio::evaluation
