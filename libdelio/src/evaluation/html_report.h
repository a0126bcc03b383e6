#pragma once
#include <iosfwd>
#include <string>
#include <vector>

#include "delio/evaluation/report.h"
#include "evaluation/charts.h"

namespace delio::evaluation {
/** A sequence as the page shows it. */
struct Section {
    Group sequence;
    std::vector<Chart> charts;
    std::vector<std::string> maps;  //!< address of each member's map; empty: it has none
};

/** With so many decimals; "-" where it is not available. */
std::string numberOrDash(double value, int decimals);

/** Writes the page. `plotFolder` holds NAME.svg of every chart. `averages`: the rows "avg". */
void writeHtml(const std::vector<Group>& byEstimate, const std::vector<Section>& sections,
               const std::vector<Chart>& overview, const std::vector<ReportRow>& averages,
               const ReportNotes& notes, const std::string& plotFolder, std::ostream& out);
}  // namespace delio::evaluation
