#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/portable_math.h"
#include "mrpt/clock.h"
#include "ouster.h"
#include "turn_times.h"

namespace delio::io {
std::vector<std::string> OusterScans::findings() const {
    std::vector<std::string> findings;
    if (mended_.count > 0) findings.push_back(interpolatedTimes(mended_.of("column")));
    if (untimed_.count > 0) findings.push_back(noTimes(untimed_.of("turn")));
    return findings;
}

double OusterScans::stampOf(const OusterFrame& frame, const std::optional<OusterTimes>& times) {
    constexpr std::uint64_t kUnix_ns = 1000000000ULL * 1000000000ULL;
    if (!times) return frame.received_s - delay_s_;
    double stamp_s = 1e-9 * static_cast<double>(times->start_ns);
    if (times->start_ns < kUnix_ns) {
        if (!clockOffset_s_) clockOffset_s_ = frame.received_s - stamp_s;
        stamp_s += *clockOffset_s_;
    }
    delay_s_ = frame.received_s - stamp_s;
    return stamp_s;
}

void OusterScans::extend(OusterFrame& frame, std::size_t end) const {
    auto& [points, rings, ends, columns, isWrong] = frame.prepared;
    if (!points) {
        points = mrpt::maps::CPointsMapXYZI::Create();
        points->resize(frame.ranges_mm.size());
        rings.resize(frame.ranges_mm.size());
        ends.reserve(info_.columns);
    }
    std::size_t count = ends.empty() ? 0 : ends.back();
    for (; columns < end; ++columns) {
        if (!frame.received[columns]) continue;
        for (std::size_t row = 0; row < info_.rows; ++row) {
            const std::size_t pixel = columns * info_.rows + row;
            if (frame.ranges_mm[pixel] == 0) continue;
            const Eigen::Vector3f point = beams_.point(pixel, frame.ranges_mm[pixel]);
            points->setPointFast(count, point.x(), point.y(), point.z());
            const float intensity = static_cast<float>(frame.reflectivities[pixel]) / 255.0F;
            points->setPointColor_fast(count, intensity, 0, 0);  // where MRPT keeps intensities
            rings[count] = static_cast<std::uint16_t>(row);
            ++count;
        }
        ends.push_back(count);
    }
}

void OusterScans::prepare(OusterFrame& frame, std::size_t column) const {
    OusterPoints& prepared = frame.prepared;
    prepared.isWrong = prepared.isWrong || column < prepared.columns;
    if (!prepared.isWrong) extend(frame, column);
}

Scan OusterScans::scanOf(OusterFrame& frame) {
    const auto times = timesOf(frame);
    if (!times) untimed_.add(1, made_);
    if (times && times->mended > 0) mended_.add(times->mended, made_);
    ++made_;
    if (frame.prepared.isWrong) frame.prepared = {};
    extend(frame, info_.columns);
    auto [points, rings, ends, columns, isWrong] = std::exchange(frame.prepared, {});
    const std::size_t count = ends.empty() ? 0 : ends.back();
    points->resize(count);
    points->mark_as_modified();
    rings.resize(count);
    Scan scan;
    scan.points = points;
    scan.rings = std::move(rings);
    if (times) {
        scan.times_s.reserve(count);
        for (std::size_t i = 0; i < ends.size(); ++i)
            scan.times_s.resize(ends[i], static_cast<float>(times->since_s[i]));
    }
    scan.stamp_s = stampOf(frame, times);
    scan.time = timeOf(scan.stamp_s);
    return scan;
}

/** The first scan shows how the sensor's clock is to be read. */
std::vector<ImuSample> OusterScans::takeImu(std::vector<OusterImu>& waiting) const {
    std::vector<ImuSample> samples;
    if (made_ == 0) return samples;
    Eigen::Isometry3d pose;
    pose.matrix() = info_.imuToSensor;
    for (const OusterImu& own : waiting)
        samples.push_back({1e-9 * static_cast<double>(own.time_ns) + clockOffset_s_.value_or(0),
                           own.rate, own.acceleration, pose});
    waiting.clear();
    return samples;
}

std::optional<OusterTimes> timesOf(const OusterFrame& frame) {
    constexpr double kTolerance = 0.02;  // real columns are within 0.0005 turns of an even course
    std::vector<double> places, times_s;
    std::vector<std::uint64_t> told_ns;
    for (std::size_t column = 0; column < frame.received.size(); ++column) {
        if (!frame.received[column]) continue;
        places.push_back(static_cast<double>(column) / static_cast<double>(frame.received.size()));
        told_ns.push_back(frame.times_ns[column]);
    }
    if (told_ns.empty()) return {};
    auto sorted = told_ns;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (const std::uint64_t time_ns : told_ns)
        times_s.push_back(1e-9 * static_cast<double>(static_cast<std::int64_t>(time_ns - *middle)));
    const auto mended = mendTurnTimes(places, kTolerance, times_s);
    if (!mended) return {};
    const std::int64_t first_ns = std::llround(1e9 * times_s.front());
    OusterTimes times;
    times.start_ns = *middle + static_cast<std::uint64_t>(first_ns);
    for (const double time_s : times_s)
        times.since_s.push_back(1e-9 * static_cast<double>(std::llround(1e9 * time_s) - first_ns));
    times.mended = *mended;
    return times;
}

OusterBeams::OusterBeams(const OusterInfo& info)
    : rows_(info.rows),
      beamOrigin_m_(static_cast<float>(std::hypot(info.beamOut_m, info.beamUp_m))) {
    const Eigen::Matrix3d rotation = info.lidarToSensor.topLeftCorner<3, 3>();
    const Eigen::Vector3d translation = info.lidarToSensor.topRightCorner<3, 1>();
    for (std::size_t column = 0; column < info.columns; ++column) {
        // It turns clockwise, angles count counter-clockwise.
        const double turned =
            2 * M_PI * (1 - static_cast<double>(column) / static_cast<double>(info.columns));
        const Eigen::Vector3d origin(info.beamOut_m * portable::cos(turned),
                                     info.beamOut_m * portable::sin(turned), info.beamUp_m);
        origins_.emplace_back((rotation * origin + translation).cast<float>());
        for (std::size_t row = 0; row < info.rows; ++row) {
            const double angle = turned - info.azimuths[row], up = info.elevations[row];
            const Eigen::Vector3d direction(portable::cos(angle) * portable::cos(up),
                                            portable::sin(angle) * portable::cos(up),
                                            portable::sin(up));
            directions_.emplace_back((rotation * direction).cast<float>());
        }
    }
}
}  // namespace delio::io
