#include "places/update_map.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>

#include "core/kd_tree.h"
#include "core/voxel_grid.h"
#include "delio/core/error.h"
#include "formats/number_line.h"
#include "places/descriptor.h"

namespace delio {
namespace {
constexpr float kSame_m = 0.3F;  // points of a map are this far apart
/** A scan reaches 60 m; a submap has points up to 50 m from its path, which is up to 25 m long on
 *  either side of its origin. */
constexpr double kTouched_m = 135;
/** A point that is farther from all submaps is outside the map: --extend adds submaps. */
constexpr double kBelongs_m = 60;

/** History of a point, without the point. */
using History = std::array<std::uint32_t, 5>;  // as PointLayer has it
History historyOf(const PointLayer& layer) {
    return {layer.first, layer.last, layer.against, layer.doubted, layer.confirmed};
}
PointLayer layerOf(const History& history) {
    PointLayer layer;
    std::tie(layer.first, layer.last, layer.against, layer.doubted) =
        std::tie(history[0], history[1], history[2], history[3]);
    layer.confirmed = history[4] != 0;
    return layer;
}

/** Layers that grow by points. */
class Layers {
 public:
    void add(const PointLayer& history, const Eigen::Vector3f& point) {
        points_[historyOf(history)].push_back(point);
    }
    std::vector<PointLayer> layers() const {
        std::vector<PointLayer> result;
        for (const auto& [history, points] : points_) {
            result.push_back(layerOf(history));
            result.back().points = Eigen::Map<const Eigen::Matrix3Xf>(
                points.front().data(), 3, static_cast<Eigen::Index>(points.size()));
        }
        return result;
    }

 private:
    std::map<History, std::vector<Eigen::Vector3f>> points_;
};

/** A point of the map that is not gone. */
struct Known {
    std::size_t submap = 0;
    PointLayer history;     //!< without points
    Eigen::Vector3f point;  //!< the submap's level frame
};

void check(const StoredMap& map, const Visit& visit) {
    for (const auto& other : map.visits()) {
        if (other.begin_s <= 0) continue;
        if (visit.begin_s <= 0)
            throw Error("the drive has no Unix times, but the visits of the map have");
        if (visit.begin_s <= other.begin_s)
            throw Error("the drive begins at " + io::dateOf(visit.begin_s) +
                        ", not after the map's visit of " + io::dateOf(other.begin_s) + " ('" +
                        other.name + "')");
    }
}

bool isNear(const KdTree& tree, const Eigen::Vector3f& point) {
    std::uint32_t index = 0;
    float squared = 0;
    return tree.nearest(point, 1, &index, &squared) > 0 && squared < kSame_m * kSame_m;
}

/** For each of `points` 1 where one of the tree's is near. */
std::vector<std::uint8_t> nearOnes(const KdTree& tree, const Eigen::Matrix3Xf& points) {
    std::vector<std::uint8_t> near(static_cast<std::size_t>(points.cols()));
    tbb::parallel_for(std::size_t{0}, near.size(), [&](std::size_t i) {
        near[i] = isNear(tree, points.col(static_cast<Eigen::Index>(i)));
    });
    return near;
}

Eigen::Matrix3Xf without(const Eigen::Matrix3Xf& points, const std::vector<std::uint8_t>& dropped,
                         std::size_t first) {
    Eigen::Matrix3Xf kept(3, points.cols());
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        if (!dropped[first + static_cast<std::size_t>(i)]) kept.col(count++) = points.col(i);
    kept.conservativeResize(3, count);
    return kept;
}

/** One visit of a map. */
class Update {
 public:
    Update(const StoredMap& map, const VisitScans& scans)
        : map_(map), scans_(scans), visit_(static_cast<std::uint32_t>(map.visits().size())) {
        for (std::size_t i = 0; i < map.submaps().size(); ++i)
            if (isTouched(i)) load(i);
        judge();
    }

    UpdateFigures figures() const { return figures_; }
    /** The submaps whose points are not those that they were. */
    const std::set<std::size_t>& changed() const { return changed_; }
    /** New layers of the submaps that the visit may have seen. */
    std::map<std::size_t, std::vector<PointLayer>> layers() const {
        std::map<std::size_t, std::vector<PointLayer>> result;
        for (const auto& [submap, layers] : layers_) result[submap] = layers.layers();
        return result;
    }

 private:
    bool isTouched(std::size_t submap) const;
    void load(std::size_t submap);
    void judge();
    void judge(const Known& known, bool isSeenThrough, bool isSeen);
    void addNew(const Eigen::Matrix3Xf& points);

    const StoredMap& map_;
    const VisitScans& scans_;
    std::uint32_t visit_;
    std::vector<Known> known_;
    std::map<std::size_t, Layers> layers_;
    std::set<std::size_t> changed_;
    UpdateFigures figures_;
};

bool Update::isTouched(std::size_t submap) const {
    const Eigen::Vector3d middle = map_.levelFrames()[submap].translation();
    return std::any_of(scans_.poses.begin(), scans_.poses.end(),
                       [&](const Eigen::Isometry3d& pose) {
                           return (pose.translation() - middle).head<2>().norm() <= kTouched_m;
                       });
}

void Update::load(std::size_t submap) {
    Layers& layers = layers_[submap];
    for (auto& layer : map_.layers(submap)) {
        const Eigen::Matrix3Xf points = std::exchange(layer.points, {});
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            if (layer.isGone())
                layers.add(layer, points.col(i));
            else
                known_.push_back({submap, layer, points.col(i)});
    }
}

void Update::judge() {
    const Eigen::Matrix3Xf own = firstOfVoxels(scans_.points, kSame_m);
    const auto known = static_cast<Eigen::Index>(known_.size());
    Eigen::Matrix3Xf all(3, known + own.cols());
    for (Eigen::Index i = 0; i < known; ++i) {
        const Known& one = known_[static_cast<std::size_t>(i)];
        all.col(i) = map_.levelFrames()[one.submap].cast<float>() * one.point;
    }
    all.rightCols(own.cols()) = own;
    const auto through = scans_.seenThrough(all);
    const Eigen::Matrix3Xf inMap = all.leftCols(known),
                           standing = without(own, through, known_.size());
    const auto seen = nearOnes(KdTree(standing), inMap);
    for (std::size_t i = 0; i < known_.size(); ++i) judge(known_[i], through[i], seen[i]);
    const Eigen::Matrix3Xf there = without(inMap, through, 0);
    addNew(without(standing, nearOnes(KdTree(there), standing), 0));
}

void Update::judge(const Known& known, bool isSeenThrough, bool isSeen) {
    PointLayer history = known.history;
    if (isSeenThrough) {
        if (!history.confirmed) {
            ++figures_.dropped;
            return;
        }
        if (history.against++ == 0) history.doubted = visit_;
        ++(history.isGone() ? figures_.gone : figures_.doubted);
    } else if (isSeen) {
        figures_.confirmed += !history.confirmed;
        history = {history.first, visit_};
    }
    if (history.isValid() != known.history.isValid()) changed_.insert(known.submap);
    layers_[known.submap].add(history, known.point);
}

void Update::addNew(const Eigen::Matrix3Xf& points) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        std::size_t nearest = 0;
        double distance = std::numeric_limits<double>::infinity();
        for (const auto& [submap, layers] : layers_) {
            const double d =
                (map_.levelFrames()[submap].translation().cast<float>() - points.col(i)).norm();
            if (d >= distance) continue;
            distance = d;
            nearest = submap;
        }
        if (distance > kBelongs_m) continue;
        PointLayer history;
        history.first = history.last = visit_;
        history.confirmed = false;
        layers_[nearest].add(history,
                             map_.levelFrames()[nearest].inverse().cast<float>() * points.col(i));
        ++figures_.seenOnce;
    }
}
}  // namespace

UpdatedMap updated(const StoredMap& map, const VisitScans& scans) {
    check(map, scans.visit);
    const Update update(map, scans);
    UpdatedMap result{map.content(), update.figures()};
    auto& content = result.content;
    content.visits = map.visits();
    content.visits.push_back(scans.visit);
    const auto layers =
        std::make_shared<const std::map<std::size_t, std::vector<PointLayer>>>(update.layers());
    content.layers = [&map, layers](std::size_t i) {
        const auto found = layers->find(i);
        return found == layers->end() ? map.layers(i) : found->second;
    };
    content.points = [all = content.layers](std::size_t i) { return validPoints(all(i)); };
    // A tile's descriptor is that of the cloud around it.
    const std::size_t tiles = map.cloudOrigin() ? map.cloudOrigin()->tiles : 0;
    content.descriptor = [&map, layers, tiles, changed = update.changed()](std::size_t i) {
        if (i < tiles || changed.count(i) == 0) return map.descriptor(i);
        return places::Descriptor(validPoints(layers->at(i)));
    };
    return result;
}
}  // namespace delio
