#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "delio/evaluation/comparison.h"
#include "delio/evaluation/report/chart.h"

namespace delio::evaluation {
/** An estimate's sequences, or a sequence's estimates. */
struct Group {
    std::string name;
    std::vector<const Comparison*> members;
    std::vector<std::size_t> estimates;  //!< of each member: which estimate it is, from 0
};

/** Errors over length and speed of the segments, over all sequences of each estimate. */
std::vector<Chart> overviewCharts(const std::vector<Group>& byEstimate);

/** Everything that is drawn of one sequence; the charts' names begin with `prefix`. */
std::vector<Chart> sequenceCharts(const Group& sequence, const std::string& prefix);
}  // namespace delio::evaluation
