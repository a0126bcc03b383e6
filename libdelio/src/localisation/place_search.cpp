#include "delio/localisation/place_search.h"

#include <algorithm>
#include <cmath>

namespace delio {
using loops::Closure;
using loops::Shift;

namespace {
constexpr double kDeg = M_PI / 180;

Eigen::Isometry3d poseOf(const Shift& shift) {
    return Eigen::Translation3d(shift.translation) *
           Eigen::AngleAxisd(shift.yaw, Eigen::Vector3d::UnitZ()) * Eigen::Isometry3d::Identity();
}

/** In fine, about a sighting: rotations first, then the shift under each. */
Shift refined(const loops::Sketch& place, const loops::Sketch& cloud, const Shift& seen) {
    constexpr double kTurn_rad = 7 * kDeg, kReach_m = 4, kApart_m = 2;
    auto turns = place.azimuths.turnsOf(cloud.azimuths, seen.yaw, kTurn_rad, 2);
    turns.push_back(seen.yaw);
    Shift best;
    for (const double yaw : turns)
        for (const auto& shift : shiftsOf(place.image, cloud.image, yaw, seen.translation.head<2>(),
                                          kReach_m, kApart_m, 1))
            if (shift.share > best.share) best = shift;
    return best;
}

struct Hypothesis {
    std::size_t place;
    Shift shift;
};
}  // namespace

std::vector<OptionField> PlaceSearchOptions::fields() const {
    using Me = PlaceSearchOptions;
    return {{"min_overlap", &Me::min_overlap,
             "share of what stands in the scans that has to stand in the map", 0, 1},
            {"max_bare", &Me::max_bare,
             "share of the walls of one that may be free space of the other", 0, 1},
            {"rival", &Me::rival, "share of the best place's overlap that another place may have",
             0, 1}};
}

PlaceSearch::PlaceSearch(std::shared_ptr<const StoredMap> map, const PlaceSearchOptions& options)
    : map_(std::move(map)), options_(options) {
    for (std::size_t i = 0; i < map_->submaps().size(); ++i) {
        sketches_.push_back(map_->sketch(i));
        index_.add(sketches_.back().image);
    }
}

FoundPlace PlaceSearch::find(const Eigen::Matrix3Xf& cloud) {
    constexpr std::size_t kMost = 20;
    const loops::Sketch seen(cloud);
    return verified(index_.find(seen.image, kMost), cloud, seen);
}

FoundPlace PlaceSearch::find(const Eigen::Matrix3Xf& cloud,
                             const std::vector<std::size_t>& submaps) {
    constexpr std::size_t kMost = 8;
    const loops::Sketch seen(cloud);
    return verified(index_.find(seen.image, submaps, kMost), cloud, seen);
}

FoundPlace PlaceSearch::verified(const std::vector<loops::Sighting>& sightings,
                                 const Eigen::Matrix3Xf& cloud, const loops::Sketch& seen) {
    constexpr std::size_t kRegistered = 5;
    constexpr double kElsewhere_m = 5, kElsewhere_rad = 20 * kDeg;
    FoundPlace best;
    best.reason = "nothing alike";
    std::vector<Hypothesis> hypotheses;
    for (const auto& sighting : sightings)
        hypotheses.push_back(
            {sighting.place, refined(sketches_[sighting.place], seen, sighting.shift)});
    std::stable_sort(hypotheses.begin(), hypotheses.end(),
                     [](const auto& a, const auto& b) { return a.shift.share > b.shift.share; });
    const auto isWorse = [&](const Hypothesis& other) {
        return other.shift.share < options_.rival * hypotheses.front().shift.share;
    };
    hypotheses.erase(std::find_if(hypotheses.begin(), hypotheses.end(), isWorse), hypotheses.end());
    if (hypotheses.size() > kRegistered) hypotheses.resize(kRegistered);
    if (hypotheses.empty()) return best;

    const loops::RegistrableSubmap registrable(cloud);
    const loops::FreeSpace free(seen.image, cloud);
    const loops::Submap itself;
    loops::ClosureOptions options;
    options.min_overlap = options_.min_overlap;
    for (const auto& hypothesis : hypotheses) {
        const auto place = grounds_.at(hypothesis.place, [&] {
            return loops::Ground(map_->points(hypothesis.place), sketches_[hypothesis.place].image);
        });
        const Closure closure = closureOf({map_->submaps()[hypothesis.place], place->map},
                                          {itself, registrable}, poseOf(hypothesis.shift), options);
        FoundPlace found;
        found.submap = hypothesis.place;
        found.overlap = closure.overlap;
        found.pose = map_->levelFrames()[hypothesis.place] * closure.level;
        found.reason = closure.reason;
        found.bare =
            std::max(place->free.builtOn(seen.image, closure.level),
                     free.builtOn(sketches_[hypothesis.place].image, closure.level.inverse()));
        const Eigen::Isometry3d apart = best.pose.inverse() * found.pose;
        const bool isElsewhere =
            apart.translation().norm() > kElsewhere_m || angleOf(apart.linear()) > kElsewhere_rad;
        if (found.overlap <= best.overlap) {
            if (isElsewhere) best.rival = std::max(best.rival, found.overlap);
            continue;
        }
        found.rival = std::max(best.rival, isElsewhere ? best.overlap : 0);
        best = found;
    }
    if (best.reason.empty() && best.bare > options_.max_bare)
        best.reason = "walls of one are free space of the other";
    if (best.reason.empty() && best.rival > options_.rival * best.overlap)
        best.reason = "two places look alike";
    return best;
}
}  // namespace delio
