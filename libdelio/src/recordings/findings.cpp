#include "findings.h"

#include <algorithm>

namespace delio::io {
namespace {
std::string counted(std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}
}  // namespace

void Findings::add(const std::string& what, std::size_t scan, std::size_t points) {
    auto same = std::find_if(all_.begin(), all_.end(),
                             [&](const Finding& other) { return other.what == what; });
    if (same == all_.end()) same = all_.insert(same, {what, 0, 0, scan});
    ++same->scans;
    same->points += points;
}

std::vector<std::string> Findings::lines() const {
    std::vector<std::string> lines;
    for (const auto& finding : all_)
        lines.push_back(finding.what + ": " +
                        (finding.points > 0 ? counted(finding.points, "point") + " of " : "") +
                        counted(finding.scans, "scan") + " (first: scan " +
                        std::to_string(finding.first) + ")");
    return lines;
}
}  // namespace delio::io
