#include "delio/places/edit_graph.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "places/close_loops.h"
#include "places/closure.h"
#include "places/loop_search.h"

namespace delio {
using places::Closure;
using places::LoopOptions;

namespace {
constexpr double kDeg = M_PI / 180;

std::string textOf(const GraphEdit& edit) {
    return (edit.kind == GraphEdit::Kind::Add ? "add " : "forbid ") + std::to_string(edit.from) +
           " " + std::to_string(edit.to);
}

bool joins(const graph::Edge& edge, std::size_t a, std::size_t b) {
    return (edge.from == a && edge.to == b) || (edge.from == b && edge.to == a);
}

/** Consecutive nodes: poses of a drive, or tiles of an imported cloud. */
bool isChain(std::size_t a, std::size_t b) { return a + 1 == b || b + 1 == a; }

/** Registers `to` to `from` within the reach of loops, and judges the result as a loop. */
Closure closureBetween(const StoredMap& map, const std::vector<Eigen::Isometry3d>& level,
                       const GraphEdit& edit) {
    constexpr double kTurn_rad = 20 * kDeg;
    const auto& submaps = map.submaps();
    const auto from = map.descriptor(edit.from), to = map.descriptor(edit.to);
    const places::DenseSubmap fromGround(map.surroundings(edit.from), from.image),
        toGround(map.surroundings(edit.to), to.image);
    const places::ClosureEnd fromEnd{submaps[edit.from], fromGround.map},
        toEnd{submaps[edit.to], toGround.map};
    const auto shifts = places::shiftsOf(from, to, level[edit.from].inverse() * level[edit.to],
                                         LoopOptions().reach, kTurn_rad, LoopOptions().rival);
    Closure best;
    best.reason = "no similar place";
    for (const auto& shift : shifts) {
        const Eigen::Isometry3d guess =
            isometry(rotationExp(shift.yaw * Eigen::Vector3d::UnitZ()), shift.translation);
        const auto closure = closureOf(fromEnd, toEnd, guess, {});
        if (closure.overlap > best.overlap) best = closure;
    }
    if (best.reason.empty() && std::max(fromGround.free.conflict(to.image, best.level),
                                        toGround.free.conflict(from.image, best.level.inverse())) >
                                   places::kMaxFreeSpaceConflict)
        best.reason = "free-space conflict";
    if (best.reason.empty()) confirm(best, fromEnd, toEnd, {});
    return best;
}

/** Without the edges between two nodes. */
graph::PoseGraph without(const graph::PoseGraph& graph, std::size_t a, std::size_t b) {
    graph::PoseGraph result;
    for (const auto& pose : graph.poses()) result.addNode(pose);
    for (const auto& edge : graph.edges())
        if (!joins(edge, a, b)) result.addEdge(edge);
    return result;
}
}  // namespace

std::vector<SubmapEdge> submapEdges(const StoredMap& map) {
    std::map<std::size_t, std::size_t> submapAt;  // by key node
    for (std::size_t i = 0; i < map.submaps().size(); ++i) submapAt[map.submaps()[i].key] = i;
    const auto& poses = map.graph().poses();
    std::vector<SubmapEdge> edges;
    for (const auto& edge : map.graph().edges()) {
        const auto from = submapAt.find(edge.from), to = submapAt.find(edge.to);
        if (isChain(edge.from, edge.to) || from == submapAt.end() || to == submapAt.end()) continue;
        const Eigen::Isometry3d off =
            edge.increment.pose.inverse() * poses[edge.from].inverse() * poses[edge.to];
        edges.push_back({from->second, to->second, edge, off.translation().norm(),
                         angleOf(off.linear()) / kDeg});
    }
    return edges;
}

void saveSubmapEdges(const std::vector<SubmapEdge>& edges, const std::string& path) {
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "from_submap,to_submap,from_node,to_node,x_m,y_m,z_m,rotation_deg,off_m,off_deg\n";
        for (const auto& [from, to, edge, off_m, off_deg] : edges) {
            const auto& pose = edge.increment.pose;
            out << from << ',' << to << ',' << edge.from << ',' << edge.to;
            for (const double value : {pose(0, 3), pose(1, 3), pose(2, 3),
                                       angleOf(pose.linear()) / kDeg, off_m, off_deg})
                out << ',' << fixed(value, 4);
            out << '\n';
        }
    });
}

std::vector<GraphEdit> readGraphEdits(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    std::vector<GraphEdit> edits;
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string kind, from, to, more;
        if (!(words >> kind)) continue;
        words >> from >> to;
        const auto a = numberIn<std::size_t>(from), b = numberIn<std::size_t>(to);
        const bool isKnown = kind == "add" || kind == "forbid";
        if (!isKnown || !a || !b || *a == *b || words >> more)
            throw Error("'" + path + "', line " + std::to_string(number) +
                        ": expected 'add A B' or 'forbid A B' with the numbers of two submaps");
        edits.push_back({kind == "add" ? GraphEdit::Kind::Add : GraphEdit::Kind::Forbid, *a, *b});
    }
    return edits;
}

MapContent edited(const StoredMap& map, const std::vector<GraphEdit>& edits) {
    MapContent content = map.content();
    const auto& submaps = map.submaps();
    for (const auto& edit : edits) {
        const auto refuse = [&](const std::string& why) {
            throw Error("'" + textOf(edit) + "': " + why);
        };
        if (std::max(edit.from, edit.to) >= submaps.size())
            refuse("the map has " + std::to_string(submaps.size()) + " submaps, counted from 0");
        const std::size_t a = submaps[edit.from].key, b = submaps[edit.to].key;
        graph::PoseGraph graph = without(content.graph, a, b);
        const bool wasThere = graph.edges().size() < content.graph.edges().size();
        if (edit.kind == GraphEdit::Kind::Forbid) {
            if (!wasThere) refuse("there is no edge between these submaps");
            if (isChain(a, b))
                refuse("this edge holds the drive or the imported cloud together and must stay");
        } else {
            const auto level = levelFrames(submaps, content.graph.poses());
            const auto closure = closureBetween(map, level, edit);
            if (!closure.reason.empty()) refuse("not accepted: " + closure.reason);
            graph::Edge edge{a, b, closure.increment};
            edge.increment.covariance.diagonal() += places::kBendingInDrive.variances();
            graph = places::closedBy(graph, edge, {});
        }
        graph.optimise({});
        content.graph = std::move(graph);
    }
    return content;
}
}  // namespace delio
