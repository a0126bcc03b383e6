#pragma once
#include <cstddef>
#include <optional>
#include <vector>

namespace delio::io {
/** Finds the wrong ones among the times of a turn's parts (columns or packets), and interpolates
 *  new ones between the neighbours of each. A sensor turns evenly, so that time rises evenly with
 *  `places`, the part of a turn to each part of it, in their order: a time is wrong where it is
 *  farther than `tolerance` turns from that line. Whole turns may be missing between two parts, but
 *  not a second. Returns how many times were wrong; nothing where most of them are, or no sensor
 *  turns at their pace: then they cannot be used. */
std::optional<std::size_t> mendTurnTimes(const std::vector<double>& places, double tolerance,
                                         std::vector<double>& times_s);
}  // namespace delio::io
