#pragma once
#include "delio/formats/scan_table.h"
#include "delio/run/run_record.h"

namespace delio::run {
/** As scans.csv has it. */
io::ScanRow scanRowOf(const RunRow& row);
}  // namespace delio::run
