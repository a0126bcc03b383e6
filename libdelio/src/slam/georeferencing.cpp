#include "slam/georeferencing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/percentile.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"

namespace delio {
using earth::FixOnTrack;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {
constexpr double kOutlier = 4;        // standard deviations, of three axes together
constexpr double kMedianOf3 = 1.538;  // of the norm of three standard normal numbers

/** Fixes whose times are seconds of a day get the day of the drive. */
earth::Fixes inDaysOf(const earth::Track& track, earth::Fixes fixes) {
    constexpr double kDay_s = 86400, kFirstUnix_s = 5e8;
    const bool isUnix = !track.stamps_s.empty() && track.stamps_s.front() > kFirstUnix_s;
    const bool areTimesOfDay = std::all_of(
        fixes.begin(), fixes.end(), [](const earth::Fix& fix) { return fix.stamp_s < 2 * kDay_s; });
    if (!isUnix || !areTimesOfDay) return fixes;
    for (auto& fix : fixes) fix.stamp_s += kDay_s * std::floor(track.stamps_s.front() / kDay_s);
    return fixes;
}

/** Why no fix lies within the drive. */
std::string whyOutside(const earth::Track& track, const earth::Fixes& fixes) {
    const auto usable =
        static_cast<std::size_t>(std::count_if(fixes.begin(), fixes.end(), earth::isUsable));
    const std::string count = std::to_string(fixes.size());
    if (usable == 0) return "none of the " + count + " GNSS fixes is usable";
    double first = INFINITY, last = -INFINITY;
    for (const auto& fix : fixes) {
        if (!earth::isUsable(fix)) continue;
        first = std::min(first, fix.stamp_s);
        last = std::max(last, fix.stamp_s);
    }
    return "the times of the " + count + " GNSS fixes (" + fixed(first, 1) + " to " +
           fixed(last, 1) + " s) lie outside of the drive's (" + fixed(track.stamps_s.front(), 1) +
           " to " + fixed(track.stamps_s.back(), 1) + " s): another clock";
}

/** A fix in the pose graph. */
struct Factor {
    FixOnTrack at;
    double repeats = 1;  //!< how many fixes share one error: the information is divided by it
};

/** Thins out fixes of one place and moment, which repeat their error. Errors of fixes that are not
 *  RTK last for many seconds. */
std::vector<Factor> factorsOf(const std::vector<FixOnTrack>& fixes,
                              const std::vector<Isometry3d>& poses) {
    constexpr double kInterval_s = 0.5, kWay_m = 0.5, kLongest_s = 10;
    constexpr double kCorrelated_s = 10, kRtk_m = 0.5;
    std::vector<Factor> factors;
    for (const auto& each : fixes) {
        if (each.node == 0) continue;  // an edge to the node after the frame: see graphWith()
        double interval_s = kInterval_s;
        if (!factors.empty()) {
            const auto& last = factors.back().at;
            interval_s = each.fix.stamp_s - last.fix.stamp_s;
            const double way_m =
                (poses[each.node].translation() - poses[last.node].translation()).norm();
            if (interval_s < kInterval_s || (way_m < kWay_m && interval_s < kLongest_s)) continue;
        }
        const bool isRtk = each.fix.covariance(0, 0) <= kRtk_m * kRtk_m;
        factors.push_back({each, isRtk ? 1 : std::max(1.0, kCorrelated_s / interval_s)});
    }
    return factors;
}

/** Flags of the errors (standard deviations) that are not outliers, for a scale by their median. */
std::vector<bool> inliersOf(const std::vector<double>& errors) {
    auto sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    const double scale = sorted.empty() ? 1 : std::max(1.0, percentileOf(sorted, 50) / kMedianOf3);
    std::vector<bool> inlier;
    inlier.reserve(errors.size());
    for (const double error : errors) inlier.push_back(error <= kOutlier * scale);
    return inlier;
}

double norm_sd(const Vector3d& error, const earth::Fix& fix) {
    return std::sqrt(error.dot(fix.covariance.inverse() * error));
}

/** The graph in the frame east, north, up: its node 0 is that frame, node i+1 is scan i. A fix is
 * an edge from node 0 whose information is that of the antenna's position, linearised about the
 * pose as it is, and next to nothing about the rotation. */
class EnuGraph {
 public:
    EnuGraph(const graph::PoseGraph& drive, const std::vector<Factor>& factors,
             const earth::Georeference& place)
        : drive_(drive), factors_(factors), enu_(place.origin) {
        for (const auto& pose : drive.poses()) poses_.push_back(place.enuFromMap * pose);
    }

    /** From the place of the fix to the antenna, east, north, up, metres. */
    Vector3d errorOf(const FixOnTrack& each) const {
        return poses_[each.node] * each.antenna - enu_.enuOf(each.fix.place);
    }

    void optimise(const std::vector<bool>& used, const graph::PoseGraphOptions& options) {
        auto graph = graphWith(used);
        graph.optimise(options);
        poses_.assign(graph.poses().begin() + 1, graph.poses().end());
    }

    const std::vector<Isometry3d>& poses() const { return poses_; }

 private:
    graph::PoseGraph graphWith(const std::vector<bool>& used) const {
        graph::PoseGraph graph;
        graph.addNode(Isometry3d::Identity());
        for (const auto& pose : poses_) graph.addNode(pose);
        for (std::size_t i = 0; i < drive_.edges().size(); ++i) {
            const auto& edge = drive_.edges()[i];
            graph.addEdge(edge.from + 1, edge.to + 1, edge.increment.pose, drive_.information(i));
        }
        bool isFirst = true;
        for (std::size_t i = 0; i < factors_.size(); ++i)
            if (used[i]) addFix(graph, factors_[i], std::exchange(isFirst, false));
        return graph;
    }

    void addFix(graph::PoseGraph& graph, const Factor& factor, bool isFirst) const {
        const FixOnTrack& each = factor.at;
        // Holds the roll about a straight track, and nothing else.
        constexpr double kLoose_rad = 30, kLevel_rad = 0.2;
        const Matrix3d R = poses_[each.node].linear();
        const Vector3d place = enu_.enuOf(each.fix.place);
        Eigen::Matrix<double, 3, 6> J;
        J.leftCols<3>() = R;
        J.rightCols<3>() = -R * hat(each.antenna);
        Matrix6 information = J.transpose() * each.fix.covariance.inverse() / factor.repeats * J;
        const double rotation = isFirst ? kLevel_rad : kLoose_rad;
        information.diagonal().tail<3>().array() += 1 / (rotation * rotation);
        information = (information + information.transpose()).eval() / 2;
        graph.addEdge(0, each.node + 1, isometry(R, place - R * each.antenna), information);
    }

    const graph::PoseGraph& drive_;
    const std::vector<Factor>& factors_;
    earth::EnuFrame enu_;
    std::vector<Isometry3d> poses_;
};

/** The fixes that agree with their neighbours in time, however far the track has drifted. */
std::vector<bool> agreeing(const EnuGraph& graph, const std::vector<Factor>& factors) {
    constexpr std::size_t kNeighbours = 10;  // on either side
    std::vector<Vector3d> offsets;
    offsets.reserve(factors.size());
    for (const auto& factor : factors) offsets.push_back(graph.errorOf(factor.at));
    std::vector<double> errors;
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const std::size_t first = i - std::min(i, kNeighbours),
                          end = std::min(i + kNeighbours + 1, factors.size());
        Vector3d middle;
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            std::vector<double> values;
            for (std::size_t k = first; k < end; ++k) values.push_back(offsets[k][axis]);
            std::sort(values.begin(), values.end());
            middle[axis] = percentileOf(values, 50);
        }
        errors.push_back(norm_sd(offsets[i] - middle, factors[i].at.fix));
    }
    return inliersOf(errors);
}

/** The fixes that agree with the poses. */
std::vector<bool> fitting(const EnuGraph& graph, const std::vector<Factor>& factors) {
    std::vector<double> errors;
    errors.reserve(factors.size());
    for (const auto& factor : factors)
        errors.push_back(norm_sd(graph.errorOf(factor.at), factor.at.fix));
    return inliersOf(errors);
}

/** Moves the poses by the fixes, all but the first in the map's frame; sets found.place. */
void optimise(const graph::PoseGraph& graph, const std::vector<Factor>& factors,
              const graph::PoseGraphOptions& options, Georeferenced& found) {
    constexpr int kRounds = 6;
    EnuGraph enu(graph, factors, found.place);
    std::vector<bool> used = agreeing(enu, factors);
    for (int round = 0; round < kRounds; ++round) {
        enu.optimise(used, options);
        const auto now = fitting(enu, factors);
        if (now == used) break;
        used = now;
    }
    const Isometry3d first = graph.poses().front();
    const Isometry3d enuFromMap = enu.poses().front() * first.inverse();
    std::vector<Isometry3d> poses;
    for (const auto& pose : enu.poses()) poses.push_back(enuFromMap.inverse() * pose);
    poses.front() = first;
    found.graph = graph.withPoses(poses);
    found.place.enuFromMap = enuFromMap;
    found.place.moveOriginToMap();
    found.figures.inGraph = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
}

void take(const earth::TrackFit& fit, earth::GnssFigures& figures) {
    figures.used = fit.inlier.size();
    figures.rejected =
        static_cast<std::size_t>(std::count(fit.inlier.begin(), fit.inlier.end(), false));
    figures.rms_m = fit.rms_m;
    figures.rmsUp_m = fit.rmsUp_m;
    figures.headingSigma_deg = fit.headingSigma_deg;
    figures.refusal = fit.refusal;
}
}  // namespace

Georeferenced georeferenced(const graph::PoseGraph& graph, const earth::Track& track,
                            const earth::Fixes& fixes, const graph::PoseGraphOptions* options) {
    Georeferenced found;
    found.graph = graph;
    const auto timed = inDaysOf(track, fixes);
    const auto onTrack = earth::fixesOn(track, timed);
    found.figures.fixes = fixes.size();
    if (onTrack.empty()) {
        found.figures.refusal = whyOutside(track, timed);
        return found;
    }
    const auto rigid = earth::fitTrack(onTrack, track.poses);
    take(rigid, found.figures);
    found.place = rigid.place;
    if (!rigid.refusal.empty()) return found;
    const auto factors = factorsOf(onTrack, track.poses);
    if (options && !factors.empty()) {
        optimise(graph, factors, *options, found);
        const auto again = earth::fitTrack(onTrack, found.graph.poses());
        take(again, found.figures);
        found.place.covariance = again.place.covariance;
    }
    found.figures.heading_deg = earth::heading_deg(found.place.enuFromMap);
    const Matrix3d R = found.place.enuFromMap.linear();
    const Matrix3d position = R * found.place.covariance.topLeftCorner<3, 3>() * R.transpose();
    found.figures.originSigma_m = position.diagonal().cwiseSqrt();
    return found;
}
}  // namespace delio
