#include "support.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace delio::loops {
namespace {
constexpr double kDeg = M_PI / 180;
constexpr double kChi2 = 22.5;  // 99.9 % of six degrees of freedom

/** How unlikely it is that a drive along `path_m` is off by that much: a chi-square. */
double chi2Of(const Eigen::Isometry3d& off, double path_m, const LoopOptions& options) {
    constexpr double kFloor_m = 0.3, kFloor_deg = 0.5;  // of registrations, and of what is level
    const double level = kFloor_m + options.drift * path_m,
                 up = kFloor_m + options.drift_up * path_m,
                 turn = kDeg * (kFloor_deg + options.drift_deg * std::sqrt(path_m / 100));
    const Eigen::Vector3d t = off.translation();
    return (t.head<2>() / level).squaredNorm() + std::pow(t.z() / up, 2) +
           std::pow(angleOf(off.linear()) / turn, 2);
}

class Support {
 public:
    Support(const std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
            const std::vector<Eigen::Isometry3d>& poses, const LoopOptions& options)
        : candidates_(candidates), submaps_(submaps), poses_(poses), options_(options) {}

    bool leadsTooFar(const LoopCandidate& loop) const {
        const Eigen::Isometry3d off = between(loop.to, loop.from) * loop.closure.level;
        return chi2Of(off, loop.path_m, options_) > kChi2;
    }

    /** Once round: along one loop, on to where the other one is, and back along that. */
    bool agree(const LoopCandidate& a, const LoopCandidate& b) const {
        const Eigen::Isometry3d round = a.closure.level * between(a.to, b.to) *
                                        b.closure.level.inverse() * between(b.from, a.from);
        return chi2Of(round, apart_m(a, b), options_) <= kChi2;
    }

    /** Along the drive, at both ends together. */
    double apart_m(const LoopCandidate& a, const LoopCandidate& b) const {
        return std::abs(submaps_[a.to].path_m - submaps_[b.to].path_m) +
               std::abs(submaps_[a.from].path_m - submaps_[b.from].path_m);
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
    Eigen::Isometry3d between(std::size_t from, std::size_t to) const {
        return levelPose(submaps_[from], poses_).inverse() * levelPose(submaps_[to], poses_);
    }

    const std::vector<LoopCandidate>& candidates_;
    const std::vector<Submap>& submaps_;
    const std::vector<Eigen::Isometry3d>& poses_;
    const LoopOptions& options_;
};
}  // namespace

void refuseUnsupported(std::vector<LoopCandidate>& candidates, const std::vector<Submap>& submaps,
                       const std::vector<Eigen::Isometry3d>& poses, const LoopOptions& options) {
    const Support support(candidates, submaps, poses, options);
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
            return k != i && support.apart_m(loop, candidates[k]) <= kNeighbours_m;
        };
        if (std::find(chosen.begin(), chosen.end(), i) == chosen.end())
            loop.closure.reason = "contradicts other loops";
        else if (std::none_of(chosen.begin(), chosen.end(), isNeighbour))
            loop.closure.reason = "no neighbour says the same";
    }
}
}  // namespace delio::loops
