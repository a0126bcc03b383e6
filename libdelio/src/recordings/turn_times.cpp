#include "turn_times.h"

#include <algorithm>
#include <cmath>

namespace delio::io {
namespace {
double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/** Seconds a turn of pairs of parts. They are some parts apart: the clock of an Ouster has a jitter
 *  of a tenth of a column. */
std::vector<double> pacesOf(const std::vector<double>& places, const std::vector<double>& times_s) {
    constexpr std::size_t kApart = 16;
    const std::size_t apart = std::min(kApart, times_s.size() / 2);
    std::vector<double> paces;
    for (std::size_t i = 0; apart > 0 && i + apart < times_s.size(); ++i)
        if (places[i + apart] > places[i])
            paces.push_back((times_s[i + apart] - times_s[i]) / (places[i + apart] - places[i]));
    return paces;
}

void interpolate(const std::vector<double>& places, double pace_s, const std::vector<bool>& right,
                 std::vector<double>& times_s) {
    const std::size_t count = times_s.size();
    std::size_t before = count, after = 0;  // the right ones about a wrong one
    for (std::size_t i = 0; i < count; ++i) {
        if (right[i]) {
            before = i;
            continue;
        }
        after = std::max(after, i);
        while (after < count && !right[after]) ++after;
        const std::size_t known = before < count ? before : after;
        const double way = before < count && after < count ? places[after] - places[before] : 0;
        const double pace = way > 0 ? (times_s[after] - times_s[before]) / way : pace_s;
        times_s[i] = times_s[known] + pace * (places[i] - places[known]);
    }
}
}  // namespace

std::optional<std::size_t> mendTurnTimes(const std::vector<double>& places, double tolerance,
                                         std::vector<double>& times_s) {
    constexpr double kShortest_s = 0.005, kLongest_s = 10, kMostMissing_s = 1;
    const auto paces = pacesOf(places, times_s);
    if (paces.empty()) return 0;  // nothing turns
    const double pace_s = medianOf(paces);
    if (!(pace_s > kShortest_s && pace_s < kLongest_s)) return {};
    std::vector<double> offsets_s;
    for (std::size_t i = 0; i < times_s.size(); ++i)
        offsets_s.push_back(times_s[i] - pace_s * places[i]);
    const double usual_s = medianOf(offsets_s);
    std::vector<bool> right;
    for (const double offset_s : offsets_s) {
        const double off_s = offset_s - usual_s;
        right.push_back(std::abs(std::remainder(off_s, pace_s)) <= tolerance * pace_s &&
                        std::abs(off_s) < kMostMissing_s);
    }
    const auto wrong = static_cast<std::size_t>(std::count(right.begin(), right.end(), false));
    if (2 * wrong >= right.size()) return {};
    interpolate(places, pace_s, right, times_s);
    return wrong;
}
}  // namespace delio::io
