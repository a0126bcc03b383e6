#include "turn_builder.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <cmath>
#include <utility>

#include "delio/core/error.h"
#include "mrpt/clock.h"
#include "turn_times.h"

namespace delio::io {
namespace {
/** More blocks or points than any turn has, so that a stopped sensor does not fill the memory. */
constexpr std::size_t kMostBlocks = 40'000, kMostPoints = 2'000'000;
constexpr double kJitter = 0.01, kRounding = 1e-6;  // turns
constexpr double kGap_s = 1;  // packets are missing: whole turns may be among them
}  // namespace

/** Goes on to this azimuth; true where a turn ends there. */
bool TurnBuilder::passes(double turns) {
    if (azimuth_ < 0) {
        turned_ = begin_ = turns;
        lower_ = 0;
    } else {
        turned_ += std::remainder(turns - azimuth_, 1.0);
    }
    azimuth_ = turns;
    // A sensor that turns the other way passes the lower end; one that shakes does not.
    const double above = turned_ + kRounding;
    const bool isAbove = above >= lower_ + 1, isBelow = turned_ < lower_ - kJitter;
    if (isAbove) lower_ = std::floor(above);
    if (isBelow) lower_ -= 1;
    return isAbove || isBelow;
}

void TurnBuilder::block(double turns, double time_s) {
    ++taken_;
    const double before = turned_;
    const bool isGap = !blocks_.empty() && std::abs(time_s - blocks_.back().time_s) > kGap_s;
    const bool ends = passes(turns - std::floor(turns));
    if (isGap || (ends && !blocks_.empty())) {
        const double now = std::exchange(turned_, before);
        endTurn(isFirst_ || isGap);
        turned_ = begin_ = now;
        isFirst_ = isGap;
    }
    if (blocks_.size() >= kMostBlocks || points_.size() >= kMostPoints) {
        endTurn(false);
        begin_ = turned_;
    }
    blocks_.push_back({std::abs(turned_ - begin_), time_s, points_.size()});
}

void TurnBuilder::add(const PacketPoint& point) { points_.push_back(point); }

void TurnBuilder::finish(const std::string& sensor) {
    endTurn(true);
    if (taken_ == 0 || made_ > 0) return;
    throw Error("only " + std::to_string(static_cast<int>(360 * inAll_)) + " of 360 degrees in " +
                std::to_string(taken_) + " blocks of a " + sensor +
                "; a scan needs at least half a revolution");
}

std::vector<double> TurnBuilder::startsOfBlocks() {
    constexpr double kTolerance = 0.25;  // the times may be those of a recorder's clock
    std::vector<double> starts_s, places;
    for (const Block& block : blocks_) {
        starts_s.push_back(block.time_s - blocks_.front().time_s);
        places.push_back(block.place);
    }
    const auto mended = mendTurnTimes(places, kTolerance, starts_s);
    if (mended && *mended > 0) mended_.add(*mended, made_);
    if (!mended) {
        untimed_.add(1, made_);
        starts_s.clear();
    }
    return starts_s;
}

Scan TurnBuilder::scanOf(const std::vector<double>& starts_s) const {
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(points_.size());
    Scan scan;
    scan.rings.reserve(points_.size());
    if (!starts_s.empty()) scan.times_s.reserve(points_.size());
    double first_s = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const std::size_t end = b + 1 < blocks_.size() ? blocks_[b + 1].first : points_.size();
        for (std::size_t i = blocks_[b].first; i < end; ++i) {
            const PacketPoint& point = points_[i];
            points->setPointFast(i, point.x, point.y, point.z);
            points->setPointIntensity(i, point.intensity);
            scan.rings.push_back(point.ring);
            if (starts_s.empty()) continue;
            const double time_s = starts_s[b] + static_cast<double>(point.after_s);
            // The stamp is the first point's time.
            if (scan.times_s.empty()) first_s = time_s;
            scan.times_s.push_back(static_cast<float>(time_s - first_s));
        }
    }
    points->mark_as_modified();
    scan.points = points;
    scan.stamp_s = blocks_.front().time_s + first_s;
    scan.time = timeOf(scan.stamp_s);
    return scan;
}

void TurnBuilder::endTurn(bool partial) {
    const double turned = std::abs(turned_ - begin_);
    if (!blocks_.empty() && (!partial || turned >= 0.5)) {
        scans_.push_back(scanOf(startsOfBlocks()));
        ++made_;
    } else {
        inAll_ += turned;
    }
    blocks_.clear();
    points_.clear();
}

std::optional<Scan> TurnBuilder::take() {
    if (scans_.empty()) return {};
    Scan scan = std::move(scans_.front());
    scans_.pop_front();
    return scan;
}

std::vector<std::string> TurnBuilder::findings() const {
    std::vector<std::string> findings;
    if (mended_.count > 0) findings.push_back(interpolatedTimes(mended_.of("block")));
    if (untimed_.count > 0) findings.push_back(noTimes(untimed_.of("turn")));
    return findings;
}
}  // namespace delio::io
