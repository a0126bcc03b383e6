#include "delio/movers/dynamic_objects.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

namespace delio::movers {
namespace {
/** As alike as two views of one thing from about the same side. */
bool alike(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    constexpr float kMetres = 0.5F, kShare = 0.3F;
    return ((a - b).array().abs() < kMetres + kShare * a.cwiseMax(b).array()).all();
}
}  // namespace

std::vector<OptionField> DynamicObjectsOptions::fields() const {
    return {{"enabled", &DynamicObjectsOptions::enabled,
             "true: what moves is kept out of registration and map"},
            {"cell_deg", &DynamicObjectsOptions::cell_deg, "deg; directions are told apart by this",
             0.2, 10},
            {"margin", &DynamicObjectsOptions::margin,
             "m; a beam that went on by this saw a place free", 0, 10},
            {"interval_s", &DynamicObjectsOptions::interval_s,
             "s; between the earlier scans that are looked at", 0.05, 100},
            {"memory_s", &DynamicObjectsOptions::memory_s, "s; the earliest of them", 0, 5},
            {"min_share", &DynamicObjectsOptions::min_share,
             "of a segment's points in places of which something is known, those seen free", 0, 1},
            {"min_known", &DynamicObjectsOptions::min_known,
             "share of its points of whose places something is known", 0, 1}};
}

bool DynamicObjects::isFree(const Object& object, const View& seen, const View& by,
                            double minKnown) const {
    const Eigen::Isometry3f toSensor = by.toMap.inverse() * seen.toMap;
    // A part of the points of something large tells as much.
    constexpr Eigen::Index kEnough = 64;
    const Eigen::Index stride = std::max<Eigen::Index>(1, object.points.cols() / kEnough);
    int free = 0, taken = 0, asked = 0;
    for (Eigen::Index i = 0; i < object.points.cols(); i += stride, ++asked) {
        const scan::Place place = by.image.at(toSensor * Eigen::Vector3f(object.points.col(i)),
                                              static_cast<float>(options_.margin));
        free += place == scan::Place::kFree;
        taken += place == scan::Place::kTaken;
    }
    const double known = free + taken;
    return free > 0 && free >= options_.min_share * known && known >= minKnown * asked;
}

bool DynamicObjects::came(const Object& object) const {
    // Leaves and edges let beams through now and then: two scans have to agree where there are two.
    constexpr std::size_t kWitnesses = 2;
    std::size_t witnesses = 0;
    for (const auto& view : views_) {
        witnesses += isFree(object, latest_, view, options_.min_known);
        if (witnesses == kWitnesses) return true;
    }
    return witnesses > 0 && witnesses == views_.size();
}

/** Those whose places are within `reach` of `x` along the map's first axis. */
DynamicObjects::Range DynamicObjects::View::objectsAbout(float x, float reach) const {
    return {std::partition_point(objects.begin(), objects.end(),
                                 [&](const Object& o) { return o.place.x() < x - reach; }),
            std::partition_point(objects.begin(), objects.end(),
                                 [&](const Object& o) { return o.place.x() <= x + reach; })};
}

/** Its speed over the ground, where it left places behind. */
std::optional<DynamicObjects::Track> DynamicObjects::trackOf(const Object& object) const {
    constexpr float kFastest_m_s = 60, kTolerance_m = 0.3F, kTolerance = 0.15F, kTurn = 0.3F;
    constexpr double kLeastKnown = 0.05;  // near the vehicle places are left below all beams
    const auto gone = [&](const Object& earlier, const View& view) {
        return isFree(earlier, view, latest_, kLeastKnown);
    };
    const auto numberOf = [](const View& view, const Object& one) {
        return static_cast<std::size_t>(&one - view.objects.data());
    };
    for (std::size_t i = 0; i < views_.size(); ++i) {
        const View& second = views_[i];
        const auto later_s = static_cast<float>(latest_.stamp_s - second.stamp_s);
        const float farthest = kFastest_m_s * later_s;
        for (const Object& there : second.objectsAbout(object.place.x(), farthest)) {
            const Eigen::Vector3f step = object.place - there.place;
            const float length = step.norm();
            if (length < static_cast<float>(options_.margin) || length > farthest ||
                !alike(there.size, object.size))
                continue;
            // It goes on as it did.
            if (there.velocity &&
                (step - later_s * *there.velocity).norm() < kTolerance_m + kTurn * length &&
                gone(there, second))
                return Track{step / later_s, {{i, numberOf(second, there)}}};
            // Or it comes from a place before that one.
            for (std::size_t j = i + 1; j < views_.size(); ++j) {
                const View& first = views_[j];
                const auto earlier_s = static_cast<float>(second.stamp_s - first.stamp_s);
                if (earlier_s < 0.75F * later_s || earlier_s > 1.5F * later_s) continue;
                const Eigen::Vector3f expected = there.place - step * earlier_s / later_s;
                const float tolerance = kTolerance_m + kTolerance * length;
                for (const Object& start : first.objectsAbout(expected.x(), tolerance))
                    if ((start.place - expected).norm() < tolerance &&
                        alike(start.size, object.size) && gone(start, first) && gone(there, second))
                        return Track{step / later_s,
                                     {{i, numberOf(second, there)}, {j, numberOf(first, start)}}};
            }
        }
    }
    return {};
}

void DynamicObjects::unmask(const Track& track) {
    for (const auto& [view, number] : track.left) {
        Object& object = views_[view].objects[number];
        if (object.isTold) continue;
        object.isTold = true;
        const Eigen::Index before = unmasked_.cols();
        unmasked_.conservativeResize(3, before + object.points.cols());
        unmasked_.rightCols(object.points.cols()) =
            (views_[view].toMap.linear() * object.points).colwise() +
            views_[view].toMap.translation();
    }
}

DynamicObjects::Sight DynamicObjects::see(const Eigen::Matrix3Xf& points,
                                          const Eigen::Matrix3Xf& all) const {
    Sight sight;
    sight.points_ = static_cast<std::size_t>(points.cols());
    tbb::parallel_invoke([&] { sight.image_ = scan::RangeImage(all, options_.cell_deg); },
                         [&] { sight.segments_ = segmentsOf(points, segmentOptions_); });
    for (const auto& segment : sight.segments_) {
        Object object;
        object.points.resize(3, static_cast<Eigen::Index>(segment.points.size()));
        for (std::size_t i = 0; i < segment.points.size(); ++i)
            object.points.col(static_cast<Eigen::Index>(i)) = points.col(segment.points[i]);
        object.centre = segment.box.center();
        object.size = segment.box.sizes();
        sight.objects_.push_back(std::move(object));
    }
    return sight;
}

std::vector<std::uint8_t> DynamicObjects::detect(Sight sight, const Eigen::Isometry3d& pose,
                                                 double stamp_s) {
    while (!views_.empty() && stamp_s - views_.back().stamp_s > options_.memory_s)
        views_.pop_back();
    latest_ = {stamp_s, pose.cast<float>(), std::move(sight.image_), std::move(sight.objects_)};
    for (auto& object : latest_.objects) object.place = latest_.toMap * object.centre;
    const auto& segments = sight.segments_;
    std::vector<std::optional<Track>> tracks(segments.size());
    std::vector<std::uint8_t> moving(segments.size());
    tbb::parallel_for(std::size_t{0}, segments.size(), [&](std::size_t i) {
        Object& object = latest_.objects[i];
        tracks[i] = trackOf(object);
        if (tracks[i]) object.velocity = tracks[i]->velocity;
        object.isTold = tracks[i] || came(object);
        moving[i] = object.isTold;
    });
    unmasked_.resize(3, 0);
    for (const auto& track : tracks)
        if (track) unmask(*track);
    std::vector<std::uint8_t> result(sight.points_);
    for (std::size_t i = 0; i < segments.size(); ++i)
        for (const Eigen::Index point : segments[i].points)
            result[static_cast<std::size_t>(point)] = moving[i];
    return result;
}

void DynamicObjects::remember(const Eigen::Isometry3d& pose) {
    // A little less: stamps are rounded.
    if (!views_.empty() && latest_.stamp_s - views_.front().stamp_s < 0.99 * options_.interval_s)
        return;
    latest_.toMap = pose.cast<float>();
    for (auto& object : latest_.objects) object.place = latest_.toMap * object.centre;
    std::sort(latest_.objects.begin(), latest_.objects.end(),
              [](const Object& a, const Object& b) { return a.place.x() < b.place.x(); });
    views_.push_front(std::move(latest_));
}
}  // namespace delio::movers
