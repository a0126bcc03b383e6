#include "support.h"

#include <algorithm>
#include <cmath>

namespace delio::loops {
namespace {
constexpr double kDeg = M_PI / 180;
constexpr double kChi2 = 22.5;  // 99.9 % of six degrees of freedom

/** How unlikely it is that a drive is off by that much after such a stretch: a chi-square. */
double chi2Of(const Eigen::Isometry3d& off, const Stretch& driven, const LoopOptions& options) {
    constexpr double kFloor_m = 0.3, kFloor_deg = 0.5;  // of registrations, and of what is level
    const Drift drift = driftOf(driven, options);
    const Eigen::Vector3d t = off.translation();
    return (t.head<2>() / (kFloor_m + drift.level_m)).squaredNorm() +
           std::pow(t.z() / (kFloor_m + drift.up_m), 2) +
           std::pow(angleOf(off.linear()) / (kFloor_deg * kDeg + drift.turn_rad), 2);
}

class Support {
 public:
    Support(const std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
            const std::vector<Eigen::Isometry3d>& level, const LoopOptions& options)
        : candidates_(candidates), submaps_(submaps), level_(level), options_(options) {}

    bool leadsTooFar(const LoopCandidate& loop) const {
        const Eigen::Isometry3d off = chain(loop.to, loop.from) * loop.closure.level;
        const Stretch driven = between(submaps_[loop.to].driven, submaps_[loop.from].driven);
        return chi2Of(off, driven, options_) > kChi2;
    }

    /** Once round: along one loop, on to where the other one is, and back along that. */
    bool agree(const LoopCandidate& a, const LoopCandidate& b) const {
        const Eigen::Isometry3d round =
            a.closure.level * chain(a.to, b.to) * b.closure.level.inverse() * chain(b.from, a.from);
        return chi2Of(round, apart(a, b), options_) <= kChi2;
    }

    /** Along the drive, at both ends together. */
    Stretch apart(const LoopCandidate& a, const LoopCandidate& b) const {
        return between(submaps_[a.to].driven, submaps_[b.to].driven) +
               between(submaps_[a.from].driven, submaps_[b.from].driven);
    }

    /** Numbers of candidates that all agree with each other: the one that agrees with most first,
     *  then whatever goes with all before it. */
    std::vector<std::size_t> clique(const std::vector<std::size_t>& loops) const {
        std::vector<std::size_t> friends(candidates_.size(), 0), order = loops, chosen;
        for (const auto i : loops)
            for (const auto k : loops) friends[i] += agree(candidates_[i], candidates_[k]);
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t i, std::size_t k) { return friends[i] > friends[k]; });
        for (const auto i : order)
            if (std::all_of(chosen.begin(), chosen.end(),
                            [&](std::size_t k) { return agree(candidates_[i], candidates_[k]); }))
                chosen.push_back(i);
        return chosen;
    }

 private:
    /** By the chain: the level frame of `to` to that of `from`. */
    Eigen::Isometry3d chain(std::size_t from, std::size_t to) const {
        return level_[from].inverse() * level_[to];
    }

    const std::vector<LoopCandidate>& candidates_;
    const std::vector<Submap>& submaps_;
    const std::vector<Eigen::Isometry3d>& level_;
    const LoopOptions& options_;
};
}  // namespace

void refuseUnsupported(std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
                       const std::vector<Eigen::Isometry3d>& level, const LoopOptions& options) {
    const Support support(candidates, submaps, level, options);
    for (auto& loop : candidates)
        if (loop.accepted() && support.leadsTooFar(loop))
            loop.closure.reason = "farther than the drive may have drifted";
    std::vector<std::size_t> loops;
    for (std::size_t i = 0; i < candidates.size(); ++i)
        if (candidates[i].accepted()) loops.push_back(i);
    const auto chosen = support.clique(loops);
    constexpr double kNeighbours_m = 150;
    for (const auto i : loops) {
        auto& loop = candidates[i];
        const auto isNeighbour = [&](std::size_t k) {
            return k != i && support.apart(loop, candidates[k]).path_m <= kNeighbours_m;
        };
        if (std::find(chosen.begin(), chosen.end(), i) == chosen.end())
            loop.closure.reason = "contradicts other loops";
        else if (std::none_of(chosen.begin(), chosen.end(), isNeighbour))
            loop.closure.reason = "no neighbour says the same";
    }
}
}  // namespace delio::loops
