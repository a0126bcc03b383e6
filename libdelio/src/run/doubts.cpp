#include "delio/run/doubts.h"

#include <mrpt/core/format.h>

#include <algorithm>
#include <map>

namespace delio::run {
namespace {
constexpr double kMostLost = 0.1;  // of all scans

bool isMore(std::size_t scans, double share, std::size_t ofAll) {
    return static_cast<double>(scans) > share * static_cast<double>(ofAll);
}

/** `isOfKind`: says it of the row with a number. */
template <typename IsOfKind>
Stretches numberedStretchesOf(const std::vector<RunRow>& rows, const IsOfKind& isOfKind) {
    Stretches found;
    std::size_t inRow = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        inRow = isOfKind(i) ? inRow + 1 : 0;
        found.scans += inRow > 0;
        if (inRow <= found.longest) continue;
        found.longest = inRow;
        found.from = rows[i + 1 - inRow].scan;
    }
    return found;
}

template <typename IsOfKind>
Stretches stretchesOf(const std::vector<RunRow>& rows, const IsOfKind& isOfKind) {
    return numberedStretchesOf(rows, [&](std::size_t i) { return isOfKind(rows[i]); });
}

/** The track of each row. Tracks that a registration or a loop links have the same number. */
std::vector<std::size_t> linkedTracksOf(const RunRecord& record) {
    std::vector<std::size_t> tracks;
    for (const auto& row : record.rows) tracks.push_back(row.track);
    for (std::size_t i = tracks.size() - 1; i-- > 0;)
        tracks[i] = std::min(tracks[i], tracks[i + 1]);
    for (const auto& [from, to] : record.closedLoops())
        std::replace(tracks.begin(), tracks.end(), std::size_t(tracks.at(to)),
                     std::size_t(tracks.at(from)));
    return tracks;
}

bool isWeak(const RunRow& row) {
    return !row.predicted && (row.quality.unobservedRotation.cols() > 0 ||
                              row.quality.unobservedTranslation.cols() > 0);
}

/** Counts each of the vehicle's axes that one of these, of the sensor, is nearest to. */
void count(const Eigen::Matrix3Xd& axes, const RunRow& row, std::array<std::size_t, 3>& counts) {
    std::array<bool, 3> open{};
    for (Eigen::Index i = 0; i < axes.cols(); ++i) {
        Eigen::Index nearest = 0;
        (row.sensorPose.linear() * axes.col(i)).cwiseAbs().maxCoeff(&nearest);
        open[static_cast<std::size_t>(nearest)] = true;
    }
    for (std::size_t k = 0; k < 3; ++k) counts[k] += open[k];
}

std::string ofAll(const Stretches& found, std::size_t pairs) {
    return mrpt::format("%zu of %zu scans (longest run %zu, from scan %zu)", found.scans, pairs,
                        found.longest, found.from);
}
}  // namespace

Doubts doubtsOf(const std::vector<RunRow>& rows) {
    Doubts doubts;
    doubts.pairs = rows.empty() ? 0 : rows.size() - 1;
    doubts.predicted = stretchesOf(rows, [](const RunRow& row) { return row.predicted; });
    doubts.lost = stretchesOf(rows, [](const RunRow& row) { return row.lost; });
    doubts.weak = stretchesOf(rows, isWeak);
    doubts.carried =
        stretchesOf(rows, [](const RunRow& row) { return isWeak(row) && row.carried; });
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const RunRow& row = rows[i];
        const Quality& quality = row.quality;
        if (!isWeak(row)) continue;
        count(quality.unobservedTranslation, row, doubts.weakAlong);
        count(quality.unobservedRotation, row, doubts.weakAbout);
    }
    doubts.searched = stretchesOf(rows, [](const RunRow& row) { return row.searched; });
    doubts.interrupted = stretchesOf(rows, [](const RunRow& row) { return row.interrupted; });
    doubts.standing = stretchesOf(rows, [](const RunRow& row) { return row.standing; });
    return doubts;
}

std::string whyUnreliable(const Doubts& doubts) {
    constexpr double kWeak = 0.5;
    if (isMore(doubts.lost.scans, kMostLost, doubts.pairs))
        return mrpt::format("lost in %zu of %zu scans", doubts.lost.scans, doubts.pairs);
    const std::size_t weak = doubts.weak.scans - doubts.carried.scans;
    if (isMore(weak, kWeak, doubts.pairs))
        return mrpt::format("%zu of %zu scans are weakly observed", weak, doubts.pairs);
    return {};
}

Stretches unlinkedOf(const RunRecord& record) {
    const bool isAnchored = record.isLocalised() || record.gnss.inGraph > 0;
    if (record.rows.empty() || isAnchored) return {};
    const auto tracks = linkedTracksOf(record);
    std::map<std::size_t, std::size_t> scans;
    for (const auto track : tracks) ++scans[track];
    const auto longest =
        std::max_element(scans.begin(), scans.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    return numberedStretchesOf(record.rows,
                               [&](std::size_t i) { return tracks[i] != longest->first; });
}

std::string whyUnreliable(const Stretches& unlinked, std::size_t scans) {
    if (!isMore(unlinked.scans, kMostLost, scans)) return {};
    return ofAll(unlinked, scans) +
           " lie in a map that no registration links to the others: only a prediction";
}

const char* stateOf(const RunRow& row) {
    if (row.lost) return "lost";
    if (row.predicted) return "predicted";
    return isWeak(row) ? "weak" : "tracked";
}

std::string textOf(const Stretches& found, std::size_t scans) {
    auto count = std::to_string(scans);
    if (found.longest == 0) return count;
    return count + mrpt::format(", longest run %zu (from scan %zu)", found.longest, found.from);
}

std::string weakAxesOf(const Doubts& doubts) {
    std::string text;
    const auto put = [&](const char* how, const std::array<std::size_t, 3>& counts) {
        for (std::size_t k = 0; k < 3; ++k)
            if (counts[k] > 0)
                text += mrpt::format("%s%s %c in %zu", text.empty() ? "" : ", ", how, "xyz"[k],
                                     counts[k]);
    };
    put("along", doubts.weakAlong);
    put("about", doubts.weakAbout);
    return text;
}

std::vector<std::string> warningsOf(const Doubts& doubts) {
    constexpr double kMany = 0.05;
    const double many = kMany * static_cast<double>(doubts.pairs);
    std::vector<std::string> warnings;
    if (static_cast<double>(doubts.predicted.scans) > many)
        warnings.push_back(
            ofAll(doubts.predicted, doubts.pairs) +
            " could not be registered: their motion is predicted, and poses before and after a "
            "long run of them may not fit together; see the column 'reason' of scans.csv");
    if (static_cast<double>(doubts.carried.scans) > many)
        warnings.push_back(ofAll(doubts.carried, doubts.pairs) + " are weakly observed (" +
                           weakAxesOf(doubts) +
                           "; the vehicle's axes): wheel odometry gives the motion along these "
                           "axes, with its own errors");
    if (static_cast<double>(doubts.weak.scans - doubts.carried.scans) > many)
        warnings.push_back(
            ofAll(doubts.weak, doubts.pairs) + " are weakly observed (" + weakAxesOf(doubts) +
            "; the vehicle's axes): the scene does not constrain the motion along these axes, so "
            "it is predicted there and may wrongly show a standstill; add wheel odometry, GNSS or "
            "an IMU for these axes (tutorials.md, section 5)");
    if (doubts.lost.scans > 0)
        warnings.push_back(ofAll(doubts.lost, doubts.pairs) +
                           " are lost: where the sensor went meanwhile is not known, and the poses "
                           "before and after them do not fit together; see the column 'state' of "
                           "scans.csv");
    if (doubts.interrupted.scans > 0)
        warnings.push_back(ofAll(doubts.interrupted, doubts.pairs) +
                           " follow a time gap or a clock jump: the motion across it was searched "
                           "for; where scans.csv says 'predicted' it was not found, and the "
                           "trajectories before and after are not connected");
    return warnings;
}

std::vector<std::string> warningsOf(const std::vector<MapFix>& fixes,
                                    const std::vector<RunRow>& rows) {
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < fixes.size();) {
        const auto where = fixes[i].where;
        std::size_t end = i;
        while (end < fixes.size() && fixes[end].where == where) ++end;
        // A place counts as found when a few scans have confirmed it.
        constexpr std::size_t kAtFirst = 5;
        const std::string scans =
            mrpt::format("scans %zu to %zu", rows[i].scan, rows[end - 1].scan);
        if (where == Whereabouts::kUnknown && end - i > kAtFirst)
            warnings.push_back(scans +
                               " were not localised in the stored map: their poses are the "
                               "odometry's, relative to the first localised scan");
        if (where == Whereabouts::kOutside)
            warnings.push_back(scans +
                               " are outside the stored map: their poses are the odometry's, "
                               "continued from the map's border");
        i = end;
    }
    return warnings;
}
}  // namespace delio::run
