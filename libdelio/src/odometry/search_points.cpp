#include "odometry/search_points.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/voxel_grid.h"

namespace delio::odometry {
namespace {
Eigen::Array3i cellOf(const Eigen::Vector3d& inCells) {
    return inCells.array().unaryExpr([](double x) { return static_cast<int>(floorOf(x)); });
}

/** Cells of half a step: a row of places needs every second cell. Bits of even cells therefore lie
 *  side by side, and bits of odd cells. */
class Grid {
 public:
    using Cell = Eigen::Array3i;

    /** False of what is so far away that little would be seen there. */
    static bool holds(const Cell& cell) {
        constexpr int kFar = 300;
        return cell.z() > -kBelow && cell.z() < kLevels - kBelow - 1 &&
               (cell.head<2>().abs() <= kFar).all();
    }

    /** For cells from `low` to `high`, and from all places about them. */
    Grid(const Eigen::Array2i& low, const Eigen::Array2i& high, int steps)
        : steps_(steps), first_(low - 2 * steps - 1), size_(high + 2 * steps + 2 - first_) {
        for (auto& words : kinds_) words.setZero((size_.x() + 1) / 2, (size_.y() + 1) / 2);
    }

    /** And those that share a side with it. */
    void mark(const Cell& cell) {
        constexpr std::uint64_t kOne = 1, kThreeOnes = 7;
        const Eigen::Array2i at = cell.head<2>() - first_;
        const int bit = cell.z() + kBelow;
        if ((at < 1 || at > size_ - 2).any() || bit < 1 || bit > kLevels - 2) return;
        word(at.x(), at.y()) |= kThreeOnes << (bit - 1);
        for (const int aside : {-1, 1}) {
            word(at.x() + aside, at.y()) |= kOne << bit;
            word(at.x(), at.y() + aside) |= kOne << bit;
        }
    }

    /** Adds, for all places of a row, whether the cell is marked as seen from there. */
    void count(const Cell& cell, int y, Eigen::Ref<Eigen::Array<std::uint64_t, -1, 1>> row) const {
        const Eigen::Array2i at = cell.head<2>() - first_ - 2 * steps_ + Eigen::Array2i(0, 2 * y);
        const int bit = cell.z() + kBelow;
        row += kinds_[kindOf(at.x(), at.y())]
                   .col(at.y() / 2)
                   .segment(at.x() / 2, row.size())
                   .unaryExpr([bit](std::uint64_t word) { return word >> bit & 1; });
    }

 private:
    static constexpr int kLevels = 64, kBelow = 16;
    static std::size_t kindOf(int x, int y) {
        return 2 * static_cast<std::size_t>(y & 1) + static_cast<std::size_t>(x & 1);
    }
    std::uint64_t& word(int x, int y) { return kinds_[kindOf(x, y)](x / 2, y / 2); }

    const int steps_;
    const Eigen::Array2i first_, size_;
    std::array<LevelCounts, 4> kinds_;  //!< a column of cells each, with a bit a level
};
}  // namespace

LevelCounts countsFrom(const LevelSquare& square, const PointMap& map,
                       const Eigen::Matrix3Xd& points) {
    const Eigen::Matrix3d inCells = 2 / square.step * square.upright.cast<double>();
    std::vector<Grid::Cell> cells;
    Eigen::Array2i low = Eigen::Array2i::Zero(), high = low;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const Grid::Cell cell = cellOf(inCells * points.col(i));
        if (!Grid::holds(cell)) continue;
        low = low.min(cell.head<2>());
        high = high.max(cell.head<2>());
        cells.push_back(cell);
    }
    Grid grid(low, high, square.steps);
    const Eigen::Isometry3d toSensor = square.middle.inverse();
    const Eigen::Matrix3d turn = inCells * toSensor.linear();
    const Eigen::Vector3d shift = inCells * toSensor.translation();
    map.forEachPoint(
        [&](const Eigen::Vector3d& point) { grid.mark(cellOf(turn * point + shift)); });
    LevelCounts counts = LevelCounts::Zero(square.side(), square.side());
    tbb::parallel_for(0, square.side(), [&](int y) {
        for (const auto& cell : cells) grid.count(cell, y, counts.col(y));
    });
    return counts;
}

namespace {
/** So many points show where a start leads to. */
constexpr Eigen::Index kEnough = 1000;
/** Of sparse scans all are needed: with half of a VLP-16's points a road was taken for a tunnel. */
constexpr Eigen::Index kDense = 2000;
/** So many show which starts are worth a closer look. */
constexpr Eigen::Index kFew = 250;
constexpr std::size_t kLikely = 60;
/** So many starts are worth registering. */
constexpr std::size_t kBest = 8;

/** By a part of the points, which may take a hundred iterations, then by all. */
PointEstimate registerInSteps(const PointMap& map, const Eigen::Matrix3Xd& points,
                              const Eigen::Isometry3d& guess, double kernel,
                              const PointRegistrationOptions& options) {
    const Eigen::Matrix3Xd part = sample(points, kDense);
    auto rough = registerToPoints(map, part, guess, kernel, options);
    if (part.cols() == points.cols()) return rough;
    auto estimate = registerToPoints(map, points, rough.pose, options.last_kernel, options);
    estimate.iterations += rough.iterations;
    estimate.kernel_m = rough.kernel_m;
    return estimate;
}

using Starts = std::vector<Eigen::Isometry3d>;

/** Of the starts the best `most`: where most of the points come to lie within `distance` of the
 *  map's, and no smaller share than `least`. */
Starts bestOf(const Starts& starts, std::size_t most, const PointMap& map,
              const Eigen::Matrix3Xd& points, double distance, double least) {
    std::vector<std::pair<double, std::size_t>> shares(starts.size());
    tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
        shares[i] = {shareAt(map, points, starts[i], distance, least), i};
    });
    std::stable_sort(shares.begin(), shares.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    Starts best;
    for (const auto& [share, i] : shares) {
        if (best.size() == most || share < least) break;
        best.push_back(starts[i]);
    }
    return best;
}

/** On a level disc about `guess`; of many those that seem best in a grid. */
Starts discAbout(const Eigen::Isometry3d& guess, double reach, const Eigen::Matrix3f& upright,
                 double step, const PointMap& map, const Eigen::Matrix3Xd& points) {
    constexpr std::size_t kMostPlaces = 50;
    // (Times between scans are never quite even: half a step is not worth a ring of starts.)
    const auto steps = static_cast<int>(std::lround(reach / step));
    std::vector<Eigen::Array2i> places;
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y)
            if (x * x + y * y <= steps * steps) places.emplace_back(x, y);
    if (places.size() > kMostPlaces) {
        const auto counts = countsFrom({guess, upright, step, steps}, map, points);
        std::stable_sort(places.begin(), places.end(), [&](const auto& a, const auto& b) {
            return counts(a.x() + steps, a.y() + steps) > counts(b.x() + steps, b.y() + steps);
        });
        places.resize(kMostPlaces);
    }
    Starts starts;
    for (const auto& place : places) {
        const Eigen::Vector3d level(place.x() * step, place.y() * step, 0),
            offset = upright.transpose().cast<double>() * level;
        starts.push_back(guess * Eigen::Translation3d(offset));
    }
    return starts;
}

/** On a level disc about `guess`, turned about the vertical. */
Starts startsAbout(const Eigen::Isometry3d& guess, const SearchReach& reach,
                   const Eigen::Matrix3f& upright, double step, const PointMap& map,
                   const Eigen::Matrix3Xd& points) {
    constexpr double kTurn_rad = 1.5 * M_PI / 180;
    const Eigen::Vector3d up = upright.row(2).transpose().cast<double>();
    const auto turns = static_cast<int>(std::lround(reach.turn_rad / kTurn_rad));
    Starts starts;
    for (int turn = -turns; turn <= turns; ++turn) {
        const Eigen::Isometry3d turned = guess * Eigen::AngleAxisd(turn * kTurn_rad, up);
        const auto disc = discAbout(turned, reach.metres, upright, step, map, points);
        starts.insert(starts.end(), disc.begin(), disc.end());
    }
    return starts;
}

/** Turned about all axes, by up to `reach` (rad). */
Starts turnsAbout(const Eigen::Isometry3d& guess, double reach, double step) {
    const int steps = static_cast<int>(reach / step);
    Starts starts;
    for (int x = -steps; x <= steps; ++x)
        for (int y = -steps; y <= steps; ++y)
            for (int z = -steps; z <= steps; ++z) {
                const Eigen::Vector3d turn(x * step, y * step, z * step);
                if (turn.norm() > reach) continue;
                starts.push_back(guess);
                starts.back().linear() *= rotationExp(turn);
            }
    return starts;
}

/** Where the starts lead to. */
std::vector<PointEstimate> placesFrom(const PointMap& map, const Eigen::Matrix3Xd& points,
                                      const Starts& starts, double kernel,
                                      const PointRegistrationOptions& options) {
    std::vector<PointEstimate> places(starts.size());
    tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
        places[i] = registerToPoints(map, points, starts[i], kernel, options);
    });
    return places;
}

bool isAmong(const Starts& places, const Eigen::Isometry3d& place, double within) {
    return std::any_of(places.begin(), places.end(), [&](const Eigen::Isometry3d& other) {
        return stepBetween(other, place).norm() < within;
    });
}
}  // namespace

PointEstimate searchPoints(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& guess, const SearchReach& reach,
                           const Eigen::Matrix3f& upright,
                           const PointRegistrationOptions& options) {
    PointEstimate best, wide;
    tbb::parallel_invoke(
        [&] { best = registerInSteps(map, points, guess, options.least_kernel, options); },
        [&] { wide = registerInSteps(map, points, guess, options.first_kernel, options); });
    const auto off = pointsOff(map, points, guess, options.least_kernel);
    if (off.cols() < options.min_matches) return best;
    const auto shareOf = [&](const PointEstimate& found, double distance) {
        return shareAt(map, off, found.pose, distance);
    };
    // Other places have to explain about as much of the whole scan: by those points alone it would
    // drive with the car beside it.
    constexpr double kAsMuch = 0.7;
    const double width = options.last_kernel, start = options.first_kernel / 2,
                 leastOfAll = kAsMuch * best.inlierRatio;
    const auto isWithin = [&](const PointEstimate& found) {
        return found.valid && (guess.translation() - found.pose.translation()).norm() <=
                                  reach.metres + options.first_kernel;
    };
    if (isWithin(wide) && wide.inlierRatio >= leastOfAll &&
        shareOf(wide, width) > shareOf(best, width))
        best = wide;
    // Another start has to explain clearly more. Half the width decides which one does: in the
    // whole width, the ground of a road fits metres beside, too.
    constexpr double kClearly = 0.1;
    const double least = shareOf(best, width) + kClearly;
    double most = 0;
    // A part of the points shows where a start leads to; all of them judge it, each place once.
    const Eigen::Matrix3Xd part = sample(off, kEnough);
    Starts judged;
    // No start leads where more of them lie on the map than come near it from there.
    const auto likely = bestOf(startsAbout(guess, reach, upright, start, map, part), kLikely, map,
                               sample(part, kFew), start / 2, 0),
               starts = bestOf(likely, kBest, map, part, start / 2, least);
    for (const auto& found : placesFrom(map, part, starts, start, options)) {
        if (!isWithin(found) || found.inlierRatio <= least || isAmong(judged, found.pose, width))
            continue;
        judged.push_back(found.pose);
        const auto all = registerToPoints(map, points, found.pose, options.least_kernel, options);
        if (!all.valid || all.inlierRatio < leastOfAll || shareOf(all, width) <= least) continue;
        const double share = shareOf(all, width / 2);
        if (share <= most) continue;
        most = share;
        best = all;
    }
    return best;
}

PointEstimate searchOnward(const PointMap& map, const Eigen::Matrix3Xd& points,
                           const Eigen::Isometry3d& latest, const Eigen::Isometry3d& increment,
                           const PointRegistrationOptions& options) {
    constexpr int kMostScans = 30;
    constexpr std::size_t kLikely = 3;
    const double start = options.first_kernel / 2;
    const Eigen::Matrix3Xd part = sample(points, kEnough);
    const Vector6 step = poseLog(increment);
    Starts onward;
    for (int scans = 2; scans <= kMostScans; ++scans)
        onward.push_back(latest * poseExp(scans * step));
    PointEstimate best;
    for (const auto& found :
         placesFrom(map, part, bestOf(onward, kLikely, map, part, start / 2, 0), start, options))
        if (found.valid && (!best.valid || found.inlierRatio > best.inlierRatio)) best = found;
    if (!best.valid) return best;
    return registerToPoints(map, points, best.pose, options.least_kernel, options);
}

PointEstimate searchTurns(const PointMap& map, const Eigen::Matrix3Xd& points,
                          const Eigen::Isometry3d& guess, double reach_rad, double enough,
                          const PointRegistrationOptions& options) {
    constexpr double kStep_rad = 0.11;
    constexpr Eigen::Index kFewest = 60;
    constexpr std::ptrdiff_t kTogether = 2;  // for any number of threads
    const double start = options.first_kernel / 2;
    const auto likely = bestOf(turnsAbout(guess, reach_rad, kStep_rad), kLikely, map,
                               sample(points, kFewest), start / 2, 0),
               starts = bestOf(likely, kBest, map, sample(points, kFew), start / 2, 0);
    const Eigen::Matrix3Xd part = sample(points, kEnough);
    PointEstimate best;
    for (auto next = starts.begin(); next != starts.end();) {
        const auto last = next + std::min(kTogether, starts.end() - next);
        for (const auto& found : placesFrom(map, part, {next, last}, start, options))
            if (found.valid && (!best.valid || found.inlierRatio > best.inlierRatio)) best = found;
        if (best.valid && best.inlierRatio >= enough) break;
        next = last;
    }
    if (!best.valid) return best;
    return registerToPoints(map, points, best.pose, options.least_kernel, options);
}

bool pointsSee(const PointMap& map, const Eigen::Matrix3Xd& points, const Eigen::Isometry3d& pose,
               const Eigen::Vector3d& axis, double probe, const PointRegistrationOptions& options) {
    constexpr double kBack = 0.3;
    const Eigen::Matrix3Xd part = sample(points, kDense);
    const Eigen::Vector3d aside = probe * axis;
    const auto found = placesFrom(
        map, part, {Eigen::Translation3d(aside) * pose, Eigen::Translation3d(-aside) * pose}, probe,
        options);
    return std::all_of(found.begin(), found.end(), [&](const PointEstimate& back) {
        const double off_m = std::abs(axis.dot(back.pose.translation() - pose.translation()));
        return back.valid && off_m <= kBack * probe;
    });
}
}  // namespace delio::odometry
