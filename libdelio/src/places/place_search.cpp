#include "places/place_search.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>

#include "delio/core/geometry.h"

namespace delio {
using places::Shift;

namespace {
constexpr double kDeg = M_PI / 180;

/** Like places::kMaxFreeSpaceConflict, but stricter, because there is no other information about
 *  the cloud's position. */
constexpr double kMaxFreeSpaceConflict = 0.2;
/** The least similarity. Places of another building rarely have more, the right ones nearly always,
 * with another sensor than the map's, too (share/doc/stored_map.md). */
constexpr double kMinSimilarity = 0.4;
constexpr double kCell_deg = 2;  // of the image that shows what a cloud saw through

Eigen::Isometry3d poseOf(const Shift& shift) {
    return isometry(rotationExp(shift.yaw * Eigen::Vector3d::UnitZ()), shift.translation);
}

/** Fine search around a match: rotations first, then the translation for each. Returns the best and
 *  its neighbours, because objects in rows are similar to each other. */
std::vector<Shift> refined(const places::Descriptor& place, const places::Descriptor& cloud,
                           const Shift& seen) {
    constexpr double kTurn_rad = 15 * kDeg, kReach_m = 8, kApart_m = 2;
    constexpr std::size_t kMost = 3;
    auto turns = place.walls.turnsOf(cloud.walls, seen.yaw, kTurn_rad, 3);
    turns.push_back(seen.yaw);
    std::vector<Shift> best;
    for (const double yaw : turns) {
        auto shifts = shiftsOf(place.image, cloud.image, yaw, seen.translation.head<2>(), kReach_m,
                               kApart_m, kMost);
        if (best.empty() || (!shifts.empty() && shifts.front().overlap > best.front().overlap))
            best = std::move(shifts);
    }
    return best;
}

/** All of a place, at the headings at which its walls are parallel to the cloud's. */
std::vector<Shift> atAllHeadings(const places::Descriptor& place, const places::Descriptor& cloud) {
    constexpr double kQuarter_rad = 95 * kDeg, kReach_m = 20, kApart_m = 2;
    constexpr std::size_t kMost = 3;
    std::vector<Shift> found;
    for (const double turn : place.walls.turnsOf(cloud.walls, 0, kQuarter_rad, 4))
        for (const double yaw : {turn, turn + M_PI})
            for (const auto& shift :
                 shiftsOf(place.image, cloud.image, yaw, {0, 0}, kReach_m, kApart_m, kMost))
                found.push_back(shift);
    return found;
}

/** True for two shifts that registration brings to the same pose. */
bool isSame(const Shift& a, const Shift& b) {
    constexpr double kSame_m = 1, kSame_rad = 5 * kDeg;
    return (a.translation - b.translation).norm() < kSame_m &&
           std::abs(std::remainder(a.yaw - b.yaw, 2 * M_PI)) < kSame_rad;
}

/** The best place of those that can be; without one, the best of all. */
FoundPlace bestOf(const std::vector<FoundPlace>& places) {
    FoundPlace best;
    best.reason = "no similar place";
    for (const auto& place : places) {
        const bool isFound = place.reason.empty(), hasBest = best.reason.empty();
        if (isFound != hasBest ? isFound : place.score() > best.score()) best = place;
    }
    return best;
}

bool isElsewhere(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    constexpr double kElsewhere_m = 0.5, kElsewhere_rad = 3 * kDeg;
    const Eigen::Isometry3d apart = a.inverse() * b;
    return apart.translation().norm() > kElsewhere_m || angleOf(apart.linear()) > kElsewhere_rad;
}
}  // namespace

std::vector<OptionField> PlaceSearchOptions::fields() const {
    using Me = PlaceSearchOptions;
    return {{"min_overlap", &Me::min_overlap,
             "minimum fraction of the scans' structure above the ground that is in the map", 0, 1},
            {"rival", &Me::rival,
             "maximum score of the second-best place, as a fraction of the best one's", 0, 1}};
}

PlaceSearch::PlaceSearch(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& options)
    : map_(std::move(map)), options_(options) {
    for (std::size_t i = 0; i < map_->submaps().size(); ++i) {
        descriptors_.push_back(map_->descriptor(i));
        index_.add(descriptors_.back().image);
    }
}

FoundPlace PlaceSearch::find(const Eigen::Matrix3Xf& cloud) {
    constexpr std::size_t kMost = 20;
    const places::Descriptor seen(cloud);
    return verified(index_.find(seen.image, kMost), cloud, seen);
}

FoundPlace PlaceSearch::find(const Eigen::Matrix3Xf& cloud,
                             const std::vector<std::size_t>& submaps) {
    constexpr std::size_t kMost = 8;
    const places::Descriptor seen(cloud);
    return verified(index_.find(seen.image, submaps, kMost), cloud, seen);
}

/** In fine, the best first; those that are clearly worse than the best are left out. Where the
 *  coarse matches are as good as each other, as in a building, the places are searched in fine. */
std::vector<PlaceSearch::Hypothesis> PlaceSearch::hypotheses(
    const std::vector<places::PlaceMatch>& matches, const places::Descriptor& seen) const {
    constexpr std::size_t kMost = 10;
    std::vector<std::size_t> unclear;
    for (const auto& match : matches)
        if (match.shift.overlap >= options_.rival * matches.front().shift.overlap)
            unclear.push_back(match.place);
    if (unclear.size() < 2) unclear.clear();
    std::sort(unclear.begin(), unclear.end());
    unclear.erase(std::unique(unclear.begin(), unclear.end()), unclear.end());
    std::vector<std::vector<Hypothesis>> found(matches.size() + unclear.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
        const bool isMatch = i < matches.size();
        const std::size_t place = isMatch ? matches[i].place : unclear[i - matches.size()];
        const auto& there = descriptors_[place];
        for (const auto& shift :
             isMatch ? refined(there, seen, matches[i].shift) : atAllHeadings(there, seen))
            found[i].push_back({place, shift});
    });
    std::vector<Hypothesis> all;
    for (const auto& some : found) all.insert(all.end(), some.begin(), some.end());
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
        return a.shift.overlap > b.shift.overlap;
    });
    std::vector<Hypothesis> kept;
    for (const auto& one : all) {
        if (kept.size() == kMost || one.shift.overlap < options_.rival * all.front().shift.overlap)
            break;
        const auto isKnown = [&](const Hypothesis& other) {
            return other.place == one.place && isSame(other.shift, one.shift);
        };
        if (std::none_of(kept.begin(), kept.end(), isKnown)) kept.push_back(one);
    }
    return kept;
}

/** Registers the cloud where a hypothesis puts it, and looks whether it can be there. */
FoundPlace PlaceSearch::registered(const Hypothesis& hypothesis, const places::DenseSubmap& place,
                                   const Seen& seen) const {
    const auto& cloud = seen.dense;
    const auto& image = descriptors_[hypothesis.place].image;
    places::ClosureOptions options;
    options.min_overlap = 0;  // it is judged by what the place could have seen
    const places::Submap itself;
    const auto closure = closureOf({map_->submaps()[hypothesis.place], place.map},
                                   {itself, cloud.map}, poseOf(hypothesis.shift), options);
    FoundPlace found;
    found.submap = hypothesis.place;
    found.pose = map_->levelFrames()[hypothesis.place] * closure.level;
    found.overlap = place.map.support(cloud.map, closure.level);
    found.similarity =
        found.overlap * closure.inlierRatio - 2 * place.map.seenThrough(seen.ranges, closure.level);
    found.closeness = place.map.closeness(cloud.map, closure.level);
    found.conflict = std::max(place.free.conflict(seen.descriptor.image, closure.level),
                              cloud.free.conflict(image, closure.level.inverse()));
    found.reason = closure.reason;
    if (found.reason.empty() && found.overlap < options_.min_overlap)
        found.reason = "too little overlap";
    if (found.reason.empty() && found.similarity < kMinSimilarity)
        found.reason = "not similar enough";
    if (found.reason.empty() && found.conflict > kMaxFreeSpaceConflict)
        found.reason = "free-space conflict";
    return found;
}

std::vector<FoundPlace> PlaceSearch::registered(const std::vector<Hypothesis>& hypotheses,
                                                const Seen& seen) {
    std::vector<std::shared_ptr<const places::DenseSubmap>> grounds;
    grounds.reserve(hypotheses.size());
    for (const auto& [place, shift] : hypotheses)
        grounds.push_back(cache_.at(place, [&, place = place] {
            return places::DenseSubmap(map_->surroundings(place), descriptors_[place].image);
        }));
    std::vector<FoundPlace> places(hypotheses.size());
    tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
        places[i] = registered(hypotheses[i], *grounds[i], seen);
    });
    return places;
}

/** Where else the cloud may be around a place that was found: rows of posts are similar to
 *  themselves. */
std::vector<PlaceSearch::Hypothesis> PlaceSearch::beside(const FoundPlace& found,
                                                         const Seen& seen) const {
    constexpr double kReach_m = 4, kApart_m = 0.9;
    constexpr std::size_t kMost = 5;
    const Eigen::Isometry3d there = map_->levelFrames()[found.submap].inverse() * found.pose;
    const double yaw = std::atan2(there(1, 0), there(0, 0));
    std::vector<Hypothesis> others;
    for (const auto& shift : shiftsOf(descriptors_[found.submap].image, seen.descriptor.image, yaw,
                                      there.translation().head<2>(), kReach_m, kApart_m, kMost))
        if (isElsewhere(poseOf(shift), there)) others.push_back({found.submap, shift});
    return others;
}

FoundPlace PlaceSearch::verified(const std::vector<places::PlaceMatch>& matches,
                                 const Eigen::Matrix3Xf& cloud,
                                 const places::Descriptor& descriptor) {
    const Seen seen{descriptor, {cloud, descriptor.image}, {cloud, kCell_deg}};
    auto places = registered(hypotheses(matches, descriptor), seen);
    FoundPlace best = bestOf(places);
    if (!best.reason.empty()) return best;
    const auto others = registered(beside(best, seen), seen);
    places.insert(places.end(), others.begin(), others.end());
    best = bestOf(places);
    for (const auto& place : places)
        if (place.reason.empty() && isElsewhere(place.pose, best.pose))
            best.rival = std::max(best.rival, place.score());
    if (best.rival > options_.rival * best.score())
        best.reason = "ambiguous: a second place is as similar";
    return best;
}
}  // namespace delio
