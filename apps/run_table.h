#pragma once
#include <iosfwd>
#include <string>

#include "delio/run/run_record.h"

namespace delio {
/** A run in a few lines for people: scans, path, time, and beside true poses the errors. `folder`:
 *  where the results are. */
void printTable(const run::RunRecord& record, const std::string& folder, std::ostream& out);

/** The same of a pose graph that was optimised again. */
void printGraphTable(const run::RunRecord& record, const std::string& folder, std::ostream& out);

/** One line: what became of a scan. */
std::string describe(const run::RunRow& row);
}  // namespace delio
