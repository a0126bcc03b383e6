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

Eigen::Isometry3d poseOf(const Shift& shift) {
    return isometry(rotationExp(shift.yaw * Eigen::Vector3d::UnitZ()), shift.translation);
}

/** Fine search around a match: rotations first, then the translation for each. Returns the best and
 *  its neighbours, because objects in rows are similar to each other. */
std::vector<Shift> refined(const places::Descriptor& place, const places::Descriptor& cloud,
                           const Shift& seen) {
    constexpr double kTurn_rad = 7 * kDeg, kReach_m = 8, kApart_m = 2;
    constexpr std::size_t kMost = 3;
    auto turns = place.walls.turnsOf(cloud.walls, seen.yaw, kTurn_rad, 2);
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

bool isElsewhere(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    constexpr double kElsewhere_m = 2, kElsewhere_rad = 20 * kDeg;
    const Eigen::Isometry3d apart = a.inverse() * b;
    return apart.translation().norm() > kElsewhere_m || angleOf(apart.linear()) > kElsewhere_rad;
}
}  // namespace

std::vector<OptionField> PlaceSearchOptions::fields() const {
    using Me = PlaceSearchOptions;
    return {{"min_overlap", &Me::min_overlap,
             "minimum fraction of the scans' structure above the ground that is in the map", 0, 1},
            {"rival", &Me::rival,
             "maximum overlap of the second-best place, as a fraction of the best one's", 0, 1}};
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

/** In fine, the best first; those that are clearly worse than the best are left out. */
std::vector<PlaceSearch::Hypothesis> PlaceSearch::hypotheses(
    const std::vector<places::PlaceMatch>& matches, const places::Descriptor& seen) const {
    constexpr std::size_t kMost = 6;
    std::vector<std::vector<Shift>> shifts(matches.size());
    tbb::parallel_for(std::size_t{0}, shifts.size(), [&](std::size_t i) {
        shifts[i] = refined(descriptors_[matches[i].place], seen, matches[i].shift);
    });
    std::vector<Hypothesis> found;
    for (std::size_t i = 0; i < shifts.size(); ++i)
        for (const auto& shift : shifts[i]) found.push_back({matches[i].place, shift});
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
        return a.shift.overlap > b.shift.overlap;
    });
    const auto isWorse = [&](const Hypothesis& other) {
        return other.shift.overlap < options_.rival * found.front().shift.overlap;
    };
    found.erase(std::find_if(found.begin(), found.end(), isWorse), found.end());
    if (found.size() > kMost) found.resize(kMost);
    return found;
}

/** Registers the cloud where a hypothesis puts it, and looks whether it can be there. */
FoundPlace PlaceSearch::registered(const Hypothesis& hypothesis, const places::DenseSubmap& place,
                                   const places::Descriptor& seen,
                                   const places::DenseSubmap& cloud) const {
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
    found.conflict = std::max(place.free.conflict(seen.image, closure.level),
                              cloud.free.conflict(image, closure.level.inverse()));
    found.reason = closure.reason;
    if (found.reason.empty() && found.overlap < options_.min_overlap)
        found.reason = "too little overlap";
    if (found.reason.empty() && found.conflict > kMaxFreeSpaceConflict)
        found.reason = "free-space conflict";
    return found;
}

FoundPlace PlaceSearch::verified(const std::vector<places::PlaceMatch>& matches,
                                 const Eigen::Matrix3Xf& cloud, const places::Descriptor& seen) {
    const places::DenseSubmap ground(cloud, seen.image);
    const auto found = hypotheses(matches, seen);
    std::vector<std::shared_ptr<const places::DenseSubmap>> grounds;
    grounds.reserve(found.size());
    for (const auto& [place, shift] : found)
        grounds.push_back(cache_.at(place, [&, place = place] {
            return places::DenseSubmap(map_->surroundings(place), descriptors_[place].image);
        }));
    std::vector<FoundPlace> places(found.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
        places[i] = registered(found[i], *grounds[i], seen, ground);
    });
    FoundPlace best;
    best.reason = "no similar place";
    for (const auto& place : places) {
        const bool isFound = place.reason.empty(), hasBest = best.reason.empty();
        if (isFound != hasBest ? isFound : place.overlap > best.overlap) best = place;
    }
    if (!best.reason.empty()) return best;
    for (const auto& place : places)
        if (place.reason.empty() && isElsewhere(place.pose, best.pose))
            best.rival = std::max(best.rival, place.overlap);
    if (best.rival > options_.rival * best.overlap)
        best.reason = "ambiguous: a second place is as similar";
    return best;
}
}  // namespace delio
