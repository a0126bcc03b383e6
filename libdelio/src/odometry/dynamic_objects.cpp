#include "odometry/dynamic_objects.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "odometry/above_ground.h"

namespace delio::odometry {
namespace {
constexpr float kMetres = 0.5F, kShare = 0.3F;

inline bool alike(float a, float b) { return std::abs(a - b) < kMetres + kShare * (a < b ? b : a); }
}  // namespace

bool alike(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return alike(a.x(), b.x()) && alike(a.y(), b.y()) && alike(a.z(), b.z());
}

void Outlines::add(const Eigen::Vector3f& place, const Eigen::Vector3f& size) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        places_[axis].push_back(place[static_cast<Eigen::Index>(axis)]);
        sizes_[axis].push_back(size[static_cast<Eigen::Index>(axis)]);
    }
}

std::pair<std::size_t, std::size_t> Outlines::about(float x, float reach) const {
    const auto& xs = places_[0];
    const auto first = std::lower_bound(xs.begin(), xs.end(), x - reach);
    return {first - xs.begin(), std::upper_bound(first, xs.end(), x + reach) - xs.begin()};
}

void Outlines::findAlike(const std::pair<std::size_t, std::size_t>& numbers,
                         const Eigen::Vector3f& size, std::vector<std::size_t>& found) const {
    const float x = size.x(), y = size.y(), z = size.z();
    const float *xs = sizes_[0].data(), *ys = sizes_[1].data(), *zs = sizes_[2].data();
    // Without branches, in numbers as wide as the sizes, first: vector instructions.
    std::vector<std::int32_t> isAlike(numbers.second - numbers.first);
    std::int32_t* const to = isAlike.data();
    for (std::size_t i = 0; i < isAlike.size(); ++i) {
        const std::size_t k = numbers.first + i;
        to[i] = std::int32_t{alike(xs[k], x)} & std::int32_t{alike(ys[k], y)} &
                std::int32_t{alike(zs[k], z)};
    }
    for (std::size_t i = 0; i < isAlike.size(); ++i)
        if (isAlike[i]) found.push_back(numbers.first + i);
}

namespace {
constexpr std::int32_t kNone = -1;

/** The points that stand above the ground, cell by cell: from each to the next one of its cell. (A
 *  list a cell would be tens of thousands of allocations a scan.) */
struct Chains {
    std::vector<std::int32_t> first, next;
    std::vector<std::size_t> filled;  //!< cells, in the order of their first points
};

Chains chainsOf(const Eigen::Matrix3Xf& points, const std::vector<float>& above,
                const LevelGrid& grid, const SegmentTuning& options) {
    Chains chains{std::vector<std::int32_t>(grid.size(), kNone),
                  std::vector<std::int32_t>(above.size(), kNone),
                  {}};
    std::vector<std::int32_t> last(grid.size(), kNone);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto height = double{above[static_cast<std::size_t>(i)]};
        if (height < options.above_ground || height > options.height) continue;
        const std::size_t cell = grid.at(points(0, i), points(1, i));
        if (cell == grid.size()) continue;
        const auto point = static_cast<std::int32_t>(i);
        if (last[cell] == kNone) {
            chains.filled.push_back(cell);
            chains.first[cell] = point;
        } else {
            chains.next[static_cast<std::size_t>(last[cell])] = point;
        }
        last[cell] = point;
    }
    return chains;
}
}  // namespace

std::vector<Segment> segmentsOf(const Eigen::Matrix3Xf& points, const SegmentTuning& options) {
    const auto above = heightsAboveGround(points, options.radius);
    const LevelGrid grid(options.cell, options.radius);
    const Chains cells = chainsOf(points, above, grid, options);
    std::vector<std::uint8_t> taken(grid.size());
    std::vector<Segment> segments;
    for (const std::size_t start : cells.filled) {
        if (taken[start]) continue;
        Segment segment;
        std::vector<std::size_t> open = {start};
        while (!open.empty()) {
            const std::size_t cell = open.back();
            open.pop_back();
            if (taken[cell]) continue;
            taken[cell] = true;
            for (Eigen::Index i = cells.first[cell]; i != kNone;
                 i = cells.next[static_cast<std::size_t>(i)]) {
                segment.points.push_back(i);
                segment.box.extend(points.col(i));
            }
            grid.forNeighbours(cell, [&](std::size_t neighbour) {
                if (!taken[neighbour] && cells.first[neighbour] != kNone) open.push_back(neighbour);
            });
        }
        const auto length = double{segment.box.sizes().head<2>().maxCoeff()};
        if (segment.points.size() >= options.min_points && length <= options.max_length)
            segments.push_back(std::move(segment));
    }
    return segments;
}

bool DynamicObjects::isFree(const Object& object, const View& seen, const View& by,
                            double minKnown) const {
    const Eigen::Isometry3f toSensor =
        Eigen::Isometry3f(by.upright.transpose()) * by.toMap.inverse() * seen.toMap;
    // A part of the points of a large object is enough.
    constexpr Eigen::Index kEnough = 64;
    const Eigen::Index stride = std::max<Eigen::Index>(1, object.points.cols() / kEnough);
    const Eigen::Index asked = (object.points.cols() + stride - 1) / stride;
    Eigen::Index free = 0, taken = 0;
    for (Eigen::Index i = 0, left = asked - 1; i < object.points.cols(); i += stride, --left) {
        const Place place = by.image.at(toSensor * Eigen::Vector3f(object.points.col(i)),
                                        static_cast<float>(dynamic_tuning::kMargin_m));
        free += place == Place::kFree;
        taken += place == Place::kTaken;
        // Mostly a few points show that the remaining ones cannot make it free.
        const auto most = static_cast<double>(free + left), known = most + double(taken);
        if (most == 0 || most < dynamic_tuning::kMinFreeRatio * known ||
            known < minKnown * double(asked))
            return false;
    }
    return asked > 0;
}

bool DynamicObjects::came(const Object& object) const {
    // Leaves and edges let beams through now and then: two scans have to agree where there are two.
    constexpr std::size_t kWitnesses = 2;
    std::size_t witnesses = 0;
    for (const auto& view : views_) {
        witnesses += isFree(object, latest_, view, dynamic_tuning::kMinKnownRatio);
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
            if (length < static_cast<float>(dynamic_tuning::kMargin_m) || length > farthest)
                continue;
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

DynamicObjects::Sight DynamicObjects::see(const Eigen::Matrix3Xf& points, RangeImage freeSpace,
                                          const Eigen::Matrix3f& upright) const {
    Sight sight;
    const Eigen::Matrix3Xf level = upright * points;
    sight.points_ = static_cast<std::size_t>(points.cols());
    sight.upright_ = upright;
    sight.image_ = std::move(freeSpace);
    sight.segments_ = segmentsOf(level, SegmentTuning());
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
    while (!views_.empty() && stamp_s - views_.back().stamp_s > dynamic_tuning::kMemory_s)
        views_.pop_back();
    latest_ = {stamp_s,
               pose.cast<float>(),
               sight.upright_,
               std::move(sight.image_),
               std::move(sight.objects_),
               {},
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
    if (!views_.empty() &&
        latest_.stamp_s - views_.front().stamp_s < 0.99 * dynamic_tuning::kInterval_s)
        return;
    latest_.toMap = pose.cast<float>();
    for (auto& object : latest_.objects) object.place = latest_.toMap * object.centre;
    std::sort(latest_.objects.begin(), latest_.objects.end(),
              [](const Object& a, const Object& b) { return a.place.x() < b.place.x(); });
    latest_.outline();
    views_.push_front(std::move(latest_));
}
}  // namespace delio::odometry
