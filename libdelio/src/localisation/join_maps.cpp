#include "delio/localisation/join_maps.h"

#include <algorithm>
#include <cmath>

#include "delio/loops/grounds.h"
#include "loops/support.h"

namespace delio {
using graph::PoseGraph;
using loops::LoopCandidate;
using loops::Submap;

namespace {
/** What a registration of submaps is off beside its noise: they are bent by the drift within them.
 */
constexpr double kBent_m = 0.02, kBent_rad = 1e-3;

/** Submaps of the map, and behind them those of the drive. */
class Both {
 public:
    Both(const StoredMap& map, const MapContent& drive, std::vector<Eigen::Isometry3d> level)
        : map_(map), drive_(drive), level_(std::move(level)), submaps_(map.submaps()) {
        const auto last = submaps_.empty() ? loops::Stretch() : submaps_.back().driven;
        for (Submap submap : drive.submaps) {
            for (auto* node : {&submap.first, &submap.key, &submap.last})
                *node += map.graph().poses().size();
            submap.driven = submap.driven + last;
            submaps_.push_back(std::move(submap));
        }
    }

    std::size_t older() const { return map_.submaps().size(); }
    const std::vector<Submap>& submaps() const { return submaps_; }
    const std::vector<Eigen::Isometry3d>& level() const { return level_; }
    loops::Sketch sketch(std::size_t i) const {
        return i < older() ? map_.sketch(i) : drive_.sketch(i - older());
    }
    Eigen::Matrix3Xf points(std::size_t i) const {
        return i < older() ? map_.points(i) : drive_.points(i - older());
    }
    std::shared_ptr<const loops::Ground> ground(std::size_t i) {
        return grounds_.at(i, [&] { return loops::Ground(points(i), sketch(i).image); });
    }

 private:
    const StoredMap& map_;
    const MapContent& drive_;
    std::vector<Eigen::Isometry3d> level_;
    std::vector<Submap> submaps_;
    loops::Grounds grounds_{6};
};

/** Where localisation puts the two submaps, registered and verified. */
void compare(Both& both, LoopCandidate& pair, const loops::ClosureOptions& options) {
    constexpr double kMoved_m = 1;  // localisation is not off by that
    const auto from = both.ground(pair.from), to = both.ground(pair.to);
    const loops::ClosureEnd fromEnd{both.submaps()[pair.from], from->map},
        toEnd{both.submaps()[pair.to], to->map};
    pair.closure = closureOf(fromEnd, toEnd, pair.expected, options);
    const auto& level = pair.closure.level;
    if (pair.accepted() && pair.moved_m() > kMoved_m)
        pair.closure.reason = "farther than localisation may be off";
    if (pair.accepted() && std::max(from->free.builtOn(both.sketch(pair.to).image, level),
                                    to->free.builtOn(both.sketch(pair.from).image,
                                                     level.inverse())) > options.max_bare)
        pair.closure.reason = "walls of one are free space of the other";
    if (pair.accepted()) confirm(pair.closure, fromEnd, toEnd, options);
}

/** All pairs that may show one place, of a drive that is known to be there. */
std::vector<LoopCandidate> jointsOf(Both& both, const std::vector<MapFix>& fixes,
                                    std::size_t nodesBefore, const loops::ClosureOptions& options) {
    constexpr double kNear_m = 25, kReach_m = 1;
    std::vector<LoopCandidate> joints;
    for (std::size_t to = both.older(); to < both.submaps().size(); ++to) {
        if (!isAnchor(fixes[both.submaps()[to].key - nodesBefore])) continue;
        for (std::size_t from = 0; from < both.older(); ++from) {
            LoopCandidate pair;
            pair.from = from;
            pair.to = to;
            pair.fromNode = both.submaps()[from].key;
            pair.toNode = both.submaps()[to].key;
            pair.path_m = between(both.submaps()[from].driven, both.submaps()[to].driven).path_m;
            pair.reach_m = kReach_m;
            pair.expected = both.level()[from].inverse() * both.level()[to];
            if (pair.expected.translation().head<2>().norm() > kNear_m) continue;
            compare(both, pair, options);
            joints.push_back(std::move(pair));
        }
    }
    return joints;
}

/** Both graphs with the edges between. */
PoseGraph together(const PoseGraph& map, const PoseGraph& drive,
                   const std::vector<LoopCandidate>& joints) {
    PoseGraph graph = map;
    const std::size_t before = map.poses().size();
    for (const auto& pose : drive.poses()) graph.addNode(pose);
    for (auto edge : drive.edges()) {
        edge.from += before;
        edge.to += before;
        graph.addEdge(edge);
    }
    Vector6 bent;
    bent << Eigen::Vector3d::Constant(kBent_m * kBent_m),
        Eigen::Vector3d::Constant(kBent_rad * kBent_rad);
    for (const auto& joint : joints) {
        if (!joint.accepted()) continue;
        graph::Edge edge{joint.fromNode, joint.toNode, joint.closure.increment};
        edge.increment.covariance.diagonal() += bent;
        graph.addEdge(edge);
    }
    return graph;
}

/** Submaps of the drive of a place that the map does not have yet. */
std::vector<std::size_t> newOnes(const Both& both, const std::vector<LoopCandidate>& joints) {
    constexpr double kSame_m = 15;
    std::vector<std::size_t> added;
    for (std::size_t i = both.older(); i < both.submaps().size(); ++i)
        if (std::none_of(joints.begin(), joints.end(), [&](const LoopCandidate& joint) {
                return joint.accepted() && joint.to == i &&
                       joint.closure.level.translation().head<2>().norm() <= kSame_m;
            }))
            added.push_back(i);
    return added;
}
}  // namespace

JoinedMap joined(const StoredMap& map, const MapContent& drive, const std::vector<MapFix>& fixes,
                 const loops::LoopOptions& loops, const loops::ClosureOptions& closures,
                 const graph::PoseGraphOptions& optimisation) {
    const std::size_t before = map.graph().poses().size();
    auto level = map.levelFrames();
    for (const auto& frame : levelFrames(drive.submaps, drive.graph.poses()))
        level.push_back(frame);
    Both both(map, drive, level);
    JoinedMap result;
    result.joints = jointsOf(both, fixes, before, closures);
    refuseUnsupported(result.joints, both.submaps(), both.level(), loops);
    result.accepted = static_cast<std::size_t>(
        std::count_if(result.joints.begin(), result.joints.end(),
                      [](const LoopCandidate& joint) { return joint.accepted(); }));
    if (result.accepted == 0) return result;
    auto& content = result.content;
    content.graph = together(map.graph(), drive.graph, result.joints);
    content.graph.optimise(optimisation);
    content.drives = map.drives();
    for (StoredDrive one : drive.drives) {
        one.firstNode += before;
        content.drives.push_back(std::move(one));
    }
    std::vector<std::size_t> kept(both.older());
    for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = i;
    const auto added = newOnes(both, result.joints);
    kept.insert(kept.end(), added.begin(), added.end());
    result.added = added.size();
    for (const auto i : kept) content.submaps.push_back(both.submaps()[i]);
    const std::size_t older = both.older();
    content.sketch = [&map, &drive, kept, older](std::size_t i) {
        return kept[i] < older ? map.sketch(kept[i]) : drive.sketch(kept[i] - older);
    };
    content.points = [&map, &drive, kept, older](std::size_t i) {
        return kept[i] < older ? map.points(kept[i]) : drive.points(kept[i] - older);
    };
    return result;
}
}  // namespace delio
