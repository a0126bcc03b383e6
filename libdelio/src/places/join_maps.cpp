#include "places/join_maps.h"

#include <algorithm>
#include <cmath>

#include "delio/core/error.h"
#include "places/close_loops.h"
#include "places/closure.h"

namespace delio {
namespace {
/** The drive's nodes in the map: from each that was measured on by the odometry, and back from the
 *  first. */
std::vector<Eigen::Isometry3d> posesIn(const std::vector<Eigen::Isometry3d>& odometry,
                                       const std::vector<MapFix>& fixes) {
    const auto first = std::find_if(fixes.begin(), fixes.end(), isAnchor);
    if (first == fixes.end()) throw Error("no scan could be localised in the map");
    auto anchor = static_cast<std::size_t>(first - fixes.begin());
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t i = 0; i < odometry.size(); ++i) {
        if (isAnchor(fixes[i])) anchor = i;
        poses.push_back(
            normalised(fixes[anchor].vehicle.pose * (odometry[anchor].inverse() * odometry[i])));
    }
    return poses;
}
}  // namespace

graph::PoseGraph anchored(const graph::PoseGraph& graph, const std::vector<MapFix>& fixes) {
    const auto poses = posesIn(graph.poses(), fixes);
    graph::PoseGraph result;
    for (const auto& pose : poses) result.addNode(pose);
    for (const auto& edge : graph.edges()) result.addEdge(edge);
    for (std::size_t i = 1; i < fixes.size(); ++i) {
        if (!isAnchor(fixes[i])) continue;
        graph::Edge edge{0, i, {poses[0].inverse() * poses[i], fixes[i].vehicle.covariance}};
        edge.increment.covariance.diagonal() += places::kBendingInMap.variances();
        result.addEdge(edge);
    }
    return result;
}

using graph::PoseGraph;
using places::LoopCandidate;
using places::Submap;

namespace {
/** Submaps of the map, and behind them those of the drive. */
class Both {
 public:
    Both(const StoredMap& map, const MapContent& drive, std::vector<Eigen::Isometry3d> level)
        : map_(map), drive_(drive), level_(std::move(level)), submaps_(map.submaps()) {
        const auto last = submaps_.empty() ? places::PathSegment() : submaps_.back().driven;
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
    places::Descriptor descriptor(std::size_t i) const {
        return i < older() ? map_.descriptor(i) : drive_.descriptor(i - older());
    }
    Eigen::Matrix3Xf points(std::size_t i) const {
        return i < older() ? map_.surroundings(i) : drive_.points(i - older());
    }
    std::shared_ptr<const places::DenseSubmap> ground(std::size_t i) {
        return grounds_.at(i, [&] { return places::DenseSubmap(points(i), descriptor(i).image); });
    }

 private:
    const StoredMap& map_;
    const MapContent& drive_;
    std::vector<Eigen::Isometry3d> level_;
    std::vector<Submap> submaps_;
    places::DenseSubmapCache grounds_{6};
};

/** Registers and verifies two submaps from their localised poses. */
void compare(Both& both, LoopCandidate& pair, const places::ClosureOptions& options) {
    constexpr double kMoved_m = 1;  // localisation is not off by that
    const auto from = both.ground(pair.from), to = both.ground(pair.to);
    const places::ClosureEnd fromEnd{both.submaps()[pair.from], from->map},
        toEnd{both.submaps()[pair.to], to->map};
    pair.closure = closureOf(fromEnd, toEnd, pair.expected, options);
    const auto& level = pair.closure.level;
    if (pair.accepted() && pair.moved_m() > kMoved_m)
        pair.closure.reason = "farther away than the localisation can be wrong";
    if (pair.accepted() &&
        std::max(from->free.conflict(both.descriptor(pair.to).image, level),
                 to->free.conflict(both.descriptor(pair.from).image, level.inverse())) >
            places::kMaxFreeSpaceConflict)
        pair.closure.reason = "free-space conflict";
    if (pair.accepted()) confirm(pair.closure, fromEnd, toEnd, options);
}

/** All pairs that may show one place, of a drive that is known to be there. */
std::vector<LoopCandidate> jointsOf(Both& both, const std::vector<MapFix>& fixes,
                                    std::size_t nodesBefore,
                                    const places::ClosureOptions& options) {
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
    for (const auto& joint : joints) {
        if (!joint.accepted()) continue;
        graph::Edge edge{joint.fromNode, joint.toNode, joint.closure.increment};
        edge.increment.covariance.diagonal() += places::kBendingInMap.variances();
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

/** The history of a map's points; the drives are one visit of it. */
void addVisits(const StoredMap& map, const MapContent& drive, const std::vector<std::size_t>& kept,
               MapContent& content) {
    content.visits = map.visits();
    content.visits.push_back(visitOf(drive.drives.front()));
    PointLayer added;
    added.first = added.last = static_cast<std::uint32_t>(map.visits().size());
    content.layers = [&map, &drive, kept, added](std::size_t i) {
        const std::size_t older = map.submaps().size();
        if (kept[i] < older) return map.layers(kept[i]);
        PointLayer layer = added;
        layer.points = drive.points(kept[i] - older);
        return std::vector<PointLayer>{layer};
    };
}
}  // namespace

JoinedMap joined(const StoredMap& map, const MapContent& drive, const std::vector<MapFix>& fixes,
                 const places::LoopOptions& loops, const places::ClosureOptions& closures,
                 const graph::PoseGraphOptions& optimisation) {
    const std::size_t before = map.graph().poses().size();
    auto level = map.levelFrames();
    for (const auto& frame : levelFrames(drive.submaps, drive.graph.poses()))
        level.push_back(frame);
    Both both(map, drive, level);
    JoinedMap result;
    result.joints = jointsOf(both, fixes, before, closures);
    refuseInconsistent(result.joints, both.submaps(), both.level(), loops);
    result.accepted = static_cast<std::size_t>(
        std::count_if(result.joints.begin(), result.joints.end(),
                      [](const LoopCandidate& joint) { return joint.accepted(); }));
    if (result.accepted == 0) return result;
    auto& content = result.content;
    content.graph = together(map.graph(), drive.graph, result.joints);
    content.graph.optimise(optimisation);
    content.drives = map.drives();
    content.cloud = map.cloudOrigin();
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
    content.descriptor = [&map, &drive, kept, older](std::size_t i) {
        return kept[i] < older ? map.descriptor(kept[i]) : drive.descriptor(kept[i] - older);
    };
    content.points = [&map, &drive, kept, older](std::size_t i) {
        return kept[i] < older ? map.points(kept[i]) : drive.points(kept[i] - older);
    };
    if (map.isUpdated()) addVisits(map, drive, kept, content);
    return result;
}
}  // namespace delio
