#include "delio/loops/loop_search.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "delio/loops/azimuths.h"
#include "delio/loops/height_image.h"

namespace delio::loops {
namespace {
constexpr double kDeg = M_PI / 180;

/** What a submap is looked for by; made when it is needed first. */
struct Place {
    std::unique_ptr<Azimuths> azimuths;
    std::unique_ptr<HeightImage> image;
    std::unique_ptr<RegistrableSubmap> map;
};

class Search {
 public:
    Search(const std::vector<Submap>& submaps, const std::vector<Eigen::Isometry3d>& poses,
           const LoopOptions& options, const ClosureOptions& closure)
        : submaps_(submaps),
          poses_(poses),
          options_(options),
          closure_(closure),
          places_(submaps.size()) {}

    std::vector<LoopCandidate> all(const std::vector<LoopCandidate>& known) {
        std::vector<LoopCandidate> candidates;
        std::vector<std::size_t> lastUse(submaps_.size(), 0);
        for (std::size_t to = 0; to < submaps_.size(); ++to)
            for (std::size_t from = 0; from < to; ++from)
                if (const auto candidate = mayMeet(from, to)) {
                    lastUse[from] = lastUse[to] = candidates.size();
                    candidates.push_back(*candidate);
                }
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            auto& candidate = candidates[i];
            const auto before =
                std::find_if(known.begin(), known.end(), [&](const LoopCandidate& other) {
                    return other.from == candidate.from && other.to == candidate.to &&
                           other.accepted();
                });
            if (before == known.end())
                search(candidate);
            else
                candidate = *before;
            for (const auto submap : {candidate.from, candidate.to})
                if (lastUse[submap] == i) places_[submap] = {};  // memory
        }
        return candidates;
    }

 private:
    /** Where the poses say that `to` lies in `from`. */
    Eigen::Isometry3d expected(const LoopCandidate& pair) const {
        return levelPose(submaps_[pair.from], poses_).inverse() *
               levelPose(submaps_[pair.to], poses_);
    }

    std::optional<LoopCandidate> mayMeet(std::size_t from, std::size_t to) const {
        constexpr double kSigmas = 3;
        LoopCandidate pair;
        pair.from = from;
        pair.to = to;
        pair.fromNode = submaps_[from].key;
        pair.toNode = submaps_[to].key;
        pair.path_m = submaps_[to].path_m - submaps_[from].path_m;
        pair.reach_m = std::min(options_.reach, 2 + kSigmas * options_.drift * pair.path_m);
        if (pair.path_m < options_.min_path) return std::nullopt;
        // Half of a submap's points lie about its path: no farther apart do two of them overlap.
        constexpr double kNear_m = 25;
        const Eigen::Vector3d apart = expected(pair).translation();
        if (apart.head<2>().norm() > kNear_m + pair.reach_m) return std::nullopt;
        return pair;
    }

    Place& place(std::size_t submap) {
        Place& place = places_[submap];
        if (!place.image) {
            const auto& points = submaps_[submap].points;
            place.azimuths = std::make_unique<Azimuths>(surfaces::estimateNormals(points, {}));
            place.image = std::make_unique<HeightImage>(points);
            place.map = std::make_unique<RegistrableSubmap>(submaps_[submap]);
        }
        return place;
    }

    /** Rotations first, then the shift under each; the best shifts, of whatever rotation. */
    std::vector<Shift> shifts(const LoopCandidate& pair, const Place& from, const Place& to) const {
        constexpr std::size_t kTurns = 3, kShifts = 3;
        constexpr double kApart_m = 2;
        const Eigen::Isometry3d guess = expected(pair);
        const double yaw = std::atan2(guess(1, 0), guess(0, 0)),
                     turn = kDeg * (5 + options_.drift_deg * std::sqrt(pair.path_m / 100));
        auto turns = from.azimuths->turnsOf(*to.azimuths, yaw, turn, kTurns);
        if (turns.empty()) turns.push_back(yaw);
        std::vector<Shift> best;
        for (const double angle : turns)
            for (const auto& shift :
                 shiftsOf(*from.image, *to.image, angle, guess.translation().head<2>(),
                          pair.reach_m, kApart_m, kShifts))
                best.push_back(shift);
        std::stable_sort(best.begin(), best.end(),
                         [](const Shift& a, const Shift& b) { return a.share > b.share; });
        // A rival is as good, or nearly: the others are not worth a registration.
        const auto isWorse = [&](const Shift& shift) {
            return shift.share < options_.rival * best.front().share;
        };
        best.erase(std::find_if(best.begin(), best.end(), isWorse), best.end());
        if (best.size() > kShifts) best.resize(kShifts);
        return best;
    }

    void search(LoopCandidate& pair) {
        const Place &from = place(pair.from), &to = place(pair.to);
        pair.closure.reason = "nothing alike";
        pair.closure.level = expected(pair);
        double rival = 0;  // overlap of the best one elsewhere
        for (const auto& shift : shifts(pair, from, to)) {
            const Eigen::Isometry3d guess = Eigen::Translation3d(shift.translation) *
                                            Eigen::AngleAxisd(shift.yaw, Eigen::Vector3d::UnitZ()) *
                                            Eigen::Isometry3d::Identity();
            const auto closure = closureOf(submaps_[pair.from], *from.map, submaps_[pair.to],
                                           *to.map, guess, closure_);
            const auto& best = pair.closure;
            const bool isBetter = closure.overlap > best.overlap;
            if (differ(closure, best))
                rival = std::max(rival, isBetter ? best.overlap : closure.overlap);
            if (!isBetter) continue;
            pair.closure = closure;
            pair.share = shift.share;
        }
        if (pair.accepted() && rival > options_.rival * pair.closure.overlap)
            pair.closure.reason = "two places look alike";
        pair.moved_m = (expected(pair).inverse() * pair.closure.level).translation().norm();
    }

    static bool differ(const Closure& a, const Closure& b) {
        constexpr double kSame_m = 0.5;
        return (a.level.translation() - b.level.translation()).norm() > kSame_m;
    }

    const std::vector<Submap>& submaps_;
    const std::vector<Eigen::Isometry3d>& poses_;
    const LoopOptions& options_;
    const ClosureOptions& closure_;
    std::vector<Place> places_;
};
}  // namespace

std::vector<OptionField> LoopOptions::fields() const {
    return {{"min_path", &LoopOptions::min_path, "m; what is seen again after less path is no loop",
             1, 1e6},
            {"drift", &LoopOptions::drift,
             "share of the path by which the odometry is off along each level axis (standard "
             "deviation)",
             1e-6, 1},
            {"drift_up", &LoopOptions::drift_up, "the same of the height", 1e-6, 1},
            {"drift_deg", &LoopOptions::drift_deg,
             "deg after 100 m; the same of the rotation, "
             "growing with the path's root",
             1e-6, 90},
            {"rival", &LoopOptions::rival,
             "share of the best place's overlap that another place may have", 0, 1},
            {"reach", &LoopOptions::reach, "m; no place is looked for farther off", 1, 1000}};
}

std::vector<LoopCandidate> searchLoops(const std::vector<Submap>& submaps,
                                       const std::vector<Eigen::Isometry3d>& poses,
                                       const LoopOptions& options, const ClosureOptions& closure,
                                       const std::vector<LoopCandidate>& known) {
    return Search(submaps, poses, options, closure).all(known);
}
}  // namespace delio::loops
