#include "delio/movers/dynamic_objects.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <iterator>

namespace delio::movers {
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
    const Eigen::Index asked = (object.points.cols() + stride - 1) / stride;
    Eigen::Index free = 0, taken = 0;
    for (Eigen::Index i = 0, left = asked - 1; i < object.points.cols(); i += stride, --left) {
        const scan::Place place = by.image.at(toSensor * Eigen::Vector3f(object.points.col(i)),
                                              static_cast<float>(options_.margin));
        free += place == scan::Place::kFree;
        taken += place == scan::Place::kTaken;
        // Mostly few points tell that all those that are left cannot make it free.
        const auto most = static_cast<double>(free + left), known = most + double(taken);
        if (most == 0 || most < options_.min_share * known || known < minKnown * double(asked))
            return false;
    }
    return asked > 0;
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

void DynamicObjects::View::outline() {
    outlines = {};
    moving.clear();
    for (std::size_t i = 0; i < objects.size(); ++i) {
        outlines.add(objects[i].place, objects[i].size);
        if (objects[i].velocity) moving.push_back(i);
    }
}

bool DynamicObjects::isGone(const Left& left) const {
    constexpr double kLeastKnown = 0.05;  // near the vehicle places are left below all beams
    const View& view = views_[left.view];
    return isFree(view.objects[left.object], view, latest_, kLeastKnown);
}

namespace {
/** Of two steps of one object the earlier one takes about as long as the later one: at least. */
bool isAsLong(double earlier_s, float later_s) {
    return static_cast<float>(earlier_s) >= 0.75F * later_s;
}
}  // namespace

/** The place that it left before `then`, from where `step` led to its own. */
std::optional<DynamicObjects::Left> DynamicObjects::leftBefore(const Left& then,
                                                               const Eigen::Vector3f& step,
                                                               const Object& object) const {
    constexpr float kTolerance_m = 0.3F, kTolerance = 0.15F;
    const View& second = views_[then.view];
    const Eigen::Vector3f place = second.outlines.place(then.object);
    const auto later_s = static_cast<float>(latest_.stamp_s - second.stamp_s);
    const float tolerance = kTolerance_m + kTolerance * step.norm();
    for (std::size_t j = then.view + 1; j < views_.size(); ++j) {
        const View& first = views_[j];
        const double between_s = second.stamp_s - first.stamp_s;
        const auto earlier_s = static_cast<float>(between_s);
        if (!isAsLong(between_s, later_s) || earlier_s > 1.5F * later_s) continue;
        const Eigen::Vector3f expected = place - step * earlier_s / later_s;
        const auto& outlines = first.outlines;
        const auto [from, to] = outlines.about(expected.x(), tolerance);
        for (std::size_t start = from; start < to; ++start)
            if ((outlines.place(start) - expected).norm() < tolerance &&
                alike(outlines.sizeOf(start), object.size) && isGone({j, start}))
                return isGone(then) ? std::optional(Left{j, start}) : std::nullopt;
    }
    return {};
}

/** The objects of a view that it may have been, by their sizes: all of them, or those that moved.
 */
void DynamicObjects::findAlike(const Object& object, const View& view, float farthest, bool all,
                               std::vector<std::size_t>& found) const {
    found.clear();
    if (all)
        view.outlines.findAlike(view.outlines.about(object.place.x(), farthest), object.size,
                                found);
    else
        std::copy_if(
            view.moving.begin(), view.moving.end(), std::back_inserter(found),
            [&](std::size_t number) { return alike(view.outlines.sizeOf(number), object.size); });
}

/** Its speed over the ground, where it left places behind. */
std::optional<DynamicObjects::Track> DynamicObjects::trackOf(const Object& object) const {
    constexpr float kFastest_m_s = 60, kTolerance_m = 0.3F, kTurn = 0.3F;
    std::vector<std::size_t> alikes;
    for (std::size_t i = 0; i < views_.size(); ++i) {
        const View& view = views_[i];
        const auto later_s = static_cast<float>(latest_.stamp_s - view.stamp_s);
        const float farthest = kFastest_m_s * later_s;
        // Of most places where it may have been nothing is known that is early enough.
        const bool knowsBefore = isAsLong(view.stamp_s - views_.back().stamp_s, later_s);
        findAlike(object, view, farthest, knowsBefore, alikes);
        for (const std::size_t there : alikes) {
            const Eigen::Vector3f step = object.place - view.outlines.place(there);
            const float length = step.norm();
            if (length < static_cast<float>(options_.margin) || length > farthest) continue;
            const Left then{i, there};
            // It goes on as it did.
            const auto& velocity = view.objects[there].velocity;
            if (velocity && (step - later_s * *velocity).norm() < kTolerance_m + kTurn * length &&
                isGone(then))
                return Track{step / later_s, {then}};
            // Or it comes from a place before that one.
            if (!knowsBefore) continue;
            if (const auto before = leftBefore(then, step, object))
                return Track{step / later_s, {then, *before}};
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
                                          const Eigen::Matrix3Xf& all,
                                          const Eigen::Matrix3f& upright) const {
    Sight sight;
    const Eigen::Matrix3Xf level = upright * points;
    sight.points_ = static_cast<std::size_t>(points.cols());
    tbb::parallel_invoke([&] { sight.image_ = scan::RangeImage(all, options_.cell_deg, upright); },
                         [&] { sight.segments_ = segmentsOf(level, segmentOptions_); });
    for (const auto& segment : sight.segments_) {
        Object object;
        object.points.resize(3, static_cast<Eigen::Index>(segment.points.size()));
        for (std::size_t i = 0; i < segment.points.size(); ++i)
            object.points.col(static_cast<Eigen::Index>(i)) = level.col(segment.points[i]);
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
    latest_ = {stamp_s, pose.cast<float>(), std::move(sight.image_), std::move(sight.objects_), {},
               {}};
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
    latest_.outline();
    views_.push_front(std::move(latest_));
}
}  // namespace delio::movers
