#include "places/loop_search.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/portable_math.h"
#include "delio/core/geometry.h"
#include "files/spool.h"
#include "places/closure.h"

namespace delio::places {
/** The submaps of a drive by number: descriptors in memory, points in a temporary file, and a cache
 * of those that were verified last. */
class SubmapStore {
 public:
    /** `folder`: of the file of points, see Spool. */
    explicit SubmapStore(std::string folder) : folder_(std::move(folder)) {}

    /** The next submap's points. Error where there is no room for them. */
    void add(const Eigen::Matrix3Xf& points);

    const Descriptor& descriptor(std::size_t submap) const { return descriptors_[submap]; }
    /** From the disk. */
    Eigen::Matrix3Xf points(std::size_t submap) const;
    /** Shifts within `reach` metres at which its height image is most similar to itself. */
    const std::vector<Shift>& repetitions(std::size_t submap, double reach);
    std::shared_ptr<const DenseSubmap> ground(std::size_t submap);

 private:
    std::string folder_;
    std::optional<io::Spool> spool_;  //!< made with the first submap
    std::vector<io::Spool::Place> points_;
    std::vector<Descriptor> descriptors_;
    std::vector<std::vector<Shift>> repetitions_;  //!< empty: not known yet
    DenseSubmapCache grounds_{5};  //!< a submap and those it is compared with, next to each other
};

void SubmapStore::add(const Eigen::Matrix3Xf& points) {
    if (!spool_) spool_.emplace(folder_, "submaps", "--no-loops");
    points_.push_back(spool_->append(points.data(), static_cast<std::size_t>(points.size())));
    descriptors_.emplace_back(points);
}

const std::vector<Shift>& SubmapStore::repetitions(std::size_t submap, double reach) {
    constexpr double kApart_m =
        4;  // nearer, walls along the road are similar, and count as one place
    constexpr std::size_t kMost = 6;
    repetitions_.resize(descriptors_.size());
    auto& shifts = repetitions_[submap];
    if (shifts.empty()) {
        const auto& image = descriptors_[submap].image;
        shifts = shiftsOf(image, image, 0, Eigen::Vector2d::Zero(), reach, kApart_m, kMost);
        if (!shifts.empty()) shifts.erase(shifts.begin());  // itself
    }
    return shifts;
}

Eigen::Matrix3Xf SubmapStore::points(std::size_t submap) const {
    const auto floats = spool_->read(points_[submap]);
    return Eigen::Map<const Eigen::Matrix3Xf>(floats.data(), 3,
                                              static_cast<Eigen::Index>(floats.size() / 3));
}

std::shared_ptr<const DenseSubmap> SubmapStore::ground(std::size_t submap) {
    return grounds_.at(submap,
                       [&] { return DenseSubmap(points(submap), descriptors_[submap].image); });
}

namespace {
constexpr double kDeg = M_PI / 180;

/** Fraction of a submap's height image that may look the same elsewhere within the search radius.
 *  With 0.55 benchmark_loops closes no wrong loop (share/doc/method/loops.md). */
constexpr double kMaxSelfSimilarity = 0.55;

bool differ(const Closure& a, const Closure& b) {
    constexpr double kSame_m = 0.5;
    return (a.level.translation() - b.level.translation()).norm() > kSame_m;
}
}  // namespace

std::vector<Shift> shiftsOf(const Descriptor& from, const Descriptor& to,
                            const Eigen::Isometry3d& guess, double reach_m, double turn_rad,
                            double rival) {
    constexpr std::size_t kTurns = 3, kShifts = 3;
    constexpr double kApart_m = 2;
    const double yaw = portable::atan2(guess(1, 0), guess(0, 0));
    auto turns = from.walls.turnsOf(to.walls, yaw, turn_rad, kTurns);
    if (turns.empty()) turns.push_back(yaw);
    std::vector<Shift> best;
    for (const double angle : turns)
        for (const auto& shift :
             shiftsOf(from.image, to.image, angle, guess.translation().head<2>(), reach_m, kApart_m,
                      kShifts))
            best.push_back(shift);
    std::stable_sort(best.begin(), best.end(),
                     [](const Shift& a, const Shift& b) { return a.overlap > b.overlap; });
    // A rival is as good, or nearly: the others are not worth a registration.
    const auto isWorse = [&](const Shift& shift) {
        return shift.overlap < rival * best.front().overlap;
    };
    best.erase(std::find_if(best.begin(), best.end(), isWorse), best.end());
    if (best.size() > kShifts) best.resize(kShifts);
    return best;
}

std::vector<OptionField> LoopOptions::fields() const {
    return {{"enabled", &LoopOptions::enabled, "false: do not search for loops"},
            {"min_path", &LoopOptions::min_path, "m; minimum path length of a loop", 1, 1e6},
            {"drift", &LoopOptions::drift,
             "assumed odometry drift along each horizontal axis, as a fraction of the path "
             "(standard deviation)",
             1e-6, 1},
            {"rival", &LoopOptions::rival,
             "maximum overlap of the second-best place, as a fraction of the best one's", 0, 1},
            {"reach", &LoopOptions::reach, "m; maximum search distance", 1, 1000}};
}

Drift driftOf(const PathSegment& driven, const LoopOptions& options) {
    const double own_m = std::sqrt(driven.variance_m2), own_rad = std::sqrt(driven.variance_rad2);
    return {options.drift * driven.path_m + own_m, kDriftUp * driven.path_m + own_m,
            kDeg * kDrift_deg * std::sqrt(driven.path_m / 100) + own_rad};
}

double LoopCandidate::moved_m() const {
    return (expected.inverse() * closure.level).translation().norm();
}

LoopSearch::LoopSearch(const LoopOptions& options, const ClosureOptions& closure,
                       std::string folder)
    : options_(options),
      closure_(closure),
      store_(std::make_unique<SubmapStore>(std::move(folder))) {}

LoopSearch::~LoopSearch() = default;

void LoopSearch::add(Submap submap, const Eigen::Isometry3d& keyPose) {
    store_->add(submap.points);
    level_.push_back(keyPose * isometry(submap.level, Eigen::Vector3d::Zero()));
    submap.points.resize(3, 0);
    submaps_.push_back(std::move(submap));
    const std::size_t to = submaps_.size() - 1;
    for (std::size_t from = 0; from < to; ++from) compare(from, to, {});
}

const Descriptor& LoopSearch::descriptor(std::size_t submap) const {
    return store_->descriptor(submap);
}

Eigen::Matrix3Xf LoopSearch::points(std::size_t submap) const { return store_->points(submap); }

void LoopSearch::again(const std::vector<Eigen::Isometry3d>& poses) {
    level_ = levelFrames(submaps_, poses);
    const auto known = std::move(candidates_);
    candidates_.clear();
    for (std::size_t to = 0; to < submaps_.size(); ++to)
        for (std::size_t from = 0; from < to; ++from) compare(from, to, known);
}

/** One more candidate, if the two may meet. */
void LoopSearch::compare(std::size_t from, std::size_t to,
                         const std::vector<LoopCandidate>& known) {
    // Half of a submap's points lie about its path: no farther apart do two of them overlap.
    constexpr double kSigmas = 3, kNear_m = 25, kStays_m = 1;
    const Submap &earlier = submaps_[from], &later = submaps_[to];
    const PathSegment driven = between(earlier.driven, later.driven);
    if (driven.path_m < options_.min_path) return;
    LoopCandidate pair;
    pair.from = from;
    pair.to = to;
    pair.fromNode = earlier.key;
    pair.toNode = later.key;
    pair.path_m = driven.path_m;
    pair.reach_m = std::min(options_.reach, 2 + kSigmas * driftOf(driven, options_).level_m);
    pair.expected = level_[from].inverse() * level_[to];
    if (pair.expected.translation().head<2>().norm() > kNear_m + pair.reach_m) return;
    const auto before = std::find_if(known.begin(), known.end(), [&](const LoopCandidate& other) {
        return other.from == from && other.to == to;
    });
    const auto stays = [&](const LoopCandidate& other) {
        return other.accepted() ||
               (other.expected.translation() - pair.expected.translation()).norm() < kStays_m;
    };
    if (before != known.end() && stays(*before))
        pair = *before;
    else
        search(pair);
    candidates_.push_back(std::move(pair));
}

void LoopSearch::search(LoopCandidate& pair) {
    constexpr double kLeast_rad = 5 * kDeg;
    const PathSegment driven = between(submaps_[pair.from].driven, submaps_[pair.to].driven);
    const double turn_rad = kLeast_rad + driftOf(driven, options_).turn_rad;
    pair.closure.reason = "no similar place";
    pair.closure.level = pair.expected;
    double rival = 0;  // overlap of the best one elsewhere
    const auto shifts = shiftsOf(store_->descriptor(pair.from), store_->descriptor(pair.to),
                                 pair.expected, pair.reach_m, turn_rad, options_.rival);
    if (shifts.empty()) return;
    const auto fromGround = store_->ground(pair.from), toGround = store_->ground(pair.to);
    const ClosureEnd from{submaps_[pair.from], fromGround->map},
        to{submaps_[pair.to], toGround->map};
    for (const auto& shift : shifts) {
        const Eigen::Isometry3d guess =
            isometry(rotationExp(shift.yaw * Eigen::Vector3d::UnitZ()), shift.translation);
        const auto closure = closureOf(from, to, guess, closure_);
        const auto& best = pair.closure;
        const bool isBetter = closure.overlap > best.overlap;
        if (differ(closure, best))
            rival = std::max(rival, isBetter ? best.overlap : closure.overlap);
        if (!isBetter) continue;
        pair.closure = closure;
        pair.imageOverlap = shift.overlap;
    }
    if (pair.accepted() && freeSpaceConflict(pair) > kMaxFreeSpaceConflict)
        pair.closure.reason = "free-space conflict";
    if (pair.accepted() && (repeats(pair.from, pair.reach_m) || repeats(pair.to, pair.reach_m)))
        pair.closure.reason = "ambiguous: the place is self-similar";
    if (pair.accepted()) confirm(pair.closure, from, to, closure_);
    if (pair.accepted() && rival > options_.rival * pair.closure.overlap)
        pair.closure.reason = "ambiguous: a second place is as similar";
}

double LoopSearch::freeSpaceConflict(const LoopCandidate& pair) const {
    const auto &from = store_->descriptor(pair.from).image, &to = store_->descriptor(pair.to).image;
    return std::max(store_->ground(pair.from)->free.conflict(to, pair.closure.level),
                    store_->ground(pair.to)->free.conflict(from, pair.closure.level.inverse()));
}

/** Rows of identical houses, tunnels: both ends of the search may be taken for each other. */
bool LoopSearch::repeats(std::size_t submap, double reach_m) {
    const auto& shifts = store_->repetitions(submap, options_.reach);
    return std::any_of(shifts.begin(), shifts.end(), [&](const Shift& shift) {
        return shift.overlap > kMaxSelfSimilarity &&
               shift.translation.head<2>().norm() <= 2 * reach_m;
    });
}
}  // namespace delio::places
