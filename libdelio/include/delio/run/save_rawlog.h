#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "delio/run/run_record.h"

namespace delio::run {
/** A rawlog that a run was made of, and its copy. */
struct RawlogCopy {
    std::string input;         //!< the run's rawlog
    std::string output;        //!< where the copy goes; a file there is replaced
    std::string label;         //!< sensor whose scans were processed, the first of several
    std::string imagesFolder;  //!< of the input's external files; empty: beside it
    double epoch_s = 0;        //!< Unix time of second 0 of RunRow::stamp_s
};

/** What a copy of a rawlog has. */
struct RawlogCopyReport {
    std::size_t actions = 0;    //!< scans with an action
    std::size_t unmatched = 0;  //!< rows of the record whose scan was not found in the rawlog
};

/** Copies a rawlog object by object and puts a CActionCollection before each scan of the record:
 *  the CActionRobotMovement3D has the vehicle's final motion since the scan before (mean and
 *  covariance, see graph::posePdfOf()), identity for the first. A bare scan becomes a
 * CSensoryFrame, as MRPT's programs want a pair of both; other objects keep their bytes. Links
 * OUT_Images to the input's folder of external files and copies the side files. Memory does not
 * grow with the rawlog. Throws Error if something cannot be read or written; then there is no copy.
 */
RawlogCopyReport saveRawlog(const RunRecord& record, const RawlogCopy& copy);

/** Paths that saveRawlog() replaces. */
std::vector<std::string> filesOfCopy(const std::string& output);
}  // namespace delio::run
