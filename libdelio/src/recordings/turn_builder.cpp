#include "turn_builder.h"

#include <algorithm>
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
    if (blocks_.size() >= kMostBlocks || count_ >= kMostPoints) {
        endTurn(false);
        begin_ = turned_;
    }
    blocks_.push_back({std::abs(turned_ - begin_), time_s, count_});
}

/** Little at a time, which is in the processor's cache when points come. */
void TurnBuilder::makeRoom() {
    constexpr std::size_t kMore = 1024;
    if (count_ == 0) {
        const std::size_t expected = most_ + most_ / 16;
        cloud_->reserve(expected);
        rings_.reserve(expected);
        times_s_.reserve(expected);
    }
    cloud_->resize(count_ + kMore);
    rings_.resize(count_ + kMore);
    times_s_.resize(count_ + kMore);
}

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

Scan TurnBuilder::takeScan(const std::vector<double>& starts_s) {
    cloud_->resize(count_);
    rings_.resize(count_);
    times_s_.resize(starts_s.empty() ? 0 : count_);
    double first_s = 0;
    for (std::size_t b = 0; b < starts_s.size(); ++b) {
        const std::size_t end = b + 1 < blocks_.size() ? blocks_[b + 1].first : count_;
        std::size_t i = blocks_[b].first;
        // The stamp is the first point's time.
        if (i == 0 && end > 0) first_s = starts_s[b] + static_cast<double>(times_s_[0]);
        for (; i < end; ++i)
            times_s_[i] =
                static_cast<float>(starts_s[b] + static_cast<double>(times_s_[i]) - first_s);
    }
    Scan scan;
    scan.points = std::exchange(cloud_, mrpt::maps::CPointsMapXYZI::Create());
    scan.rings = std::exchange(rings_, {});
    scan.times_s = std::exchange(times_s_, {});
    scan.stamp_s = blocks_.front().time_s + first_s;
    scan.time = timeOf(scan.stamp_s);
    most_ = std::max(most_, std::exchange(count_, 0));
    return scan;
}

void TurnBuilder::endTurn(bool partial) {
    const double turned = std::abs(turned_ - begin_);
    if (!blocks_.empty() && (!partial || turned >= 0.5)) {
        scans_.push_back(takeScan(startsOfBlocks()));
        ++made_;
    } else {
        inAll_ += turned;
    }
    blocks_.clear();
    count_ = 0;
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
