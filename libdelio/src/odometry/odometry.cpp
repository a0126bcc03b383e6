#include "delio/odometry/odometry.h"

#include <algorithm>
#include <string>

#include "delio/core/error.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/step.h"
#include "odometry/paper_odometry.h"
#include "odometry/pipeline.h"
#include "odometry/reporting.h"

namespace delio {
namespace {
void requireOneForEach(const char* field, std::size_t values, const Scan& scan) {
    const std::size_t points = scan.points->size();
    if (values != 0 && values != points)
        throw Error("scan " + std::to_string(scan.index) + ": " + field + " has " +
                    std::to_string(values) + " values for " + std::to_string(points) +
                    " points: give one for each point, or none");
}
}  // namespace

void requireConsistent(const Scan& scan) {
    const std::string name = "scan " + std::to_string(scan.index);
    if (!scan.points) throw Error(name + ": points is null: give a points map, which may be empty");
    requireOneForEach("rings", scan.rings.size(), scan);
    requireOneForEach("times_s", scan.times_s.size(), scan);
    if (!scan.sensorPose.matrix().allFinite()) throw Error(name + ": sensorPose is not finite");
}

double scaleOf(const Scan& scan) {
    constexpr double kShare = 0.9, kStreet_m = 16, kLeast = 0.25;
    constexpr std::size_t kEnough = 10000;
    std::vector<float> ranges;
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    for (std::size_t i = 0; i < x.size(); i += 1 + x.size() / kEnough) {
        const float range = Eigen::Vector3f(x[i], y[i], z[i]).norm();
        if (std::isfinite(range) && range > 0) ranges.push_back(range);
    }
    if (ranges.empty()) return 1;
    const auto most = ranges.begin() +
                      static_cast<std::ptrdiff_t>(kShare * static_cast<double>(ranges.size() - 1));
    std::nth_element(ranges.begin(), most, ranges.end());
    return std::clamp(static_cast<double>(*most) / kStreet_m, kLeast, 1.0);
}

void Odometry::addImu(const ImuSample& /*sample*/) {}

std::optional<ImuReport> Odometry::imuReport() const { return {}; }

void Odometry::addOdometry(const OdometrySample& /*sample*/) {}

std::optional<OdometryReport> Odometry::odometryReport() const { return {}; }

namespace odometry {
Quality qualityOf(const RotationEstimate& rotation, const TranslationEstimate& translation) {
    Quality quality;
    quality.matches = translation.matches;
    quality.residual_m = translation.residual_m;
    quality.rotationObservability = rotation.observability;
    quality.translationObservability = translation.observability;
    quality.unobservedRotation = rotation.unobservedAxes;
    quality.unobservedTranslation = rotation.rotation.transpose() * translation.unobservedAxes;
    return quality;
}

std::vector<Named> noTimes() {
    return {{"preprocess", 0}, {"undistort", 0}, {"thinning", 0},  {"points", 0},
            {"dynamic", 0},    {"planes", 0},    {"map_update", 0}};
}

StageTimer::~StageTimer() {
    const double ms = watch_.lap_ms();
    auto& times = step_.times_ms;
    const auto time = std::find_if(times.begin(), times.end(),
                                   [&](const Named& each) { return each.first == stage_; });
    if (time == times.end())
        times.emplace_back(stage_, ms);
    else
        time->second += ms;
}
}  // namespace odometry

std::unique_ptr<Odometry> makeOdometry(const OdometryOptions& options) {
    for (const auto& [section, stage] : stagesOf(options)) stage->check(section);
    if (options.isPaper()) return std::make_unique<odometry::PaperOdometry>(options.paper);
    return std::make_unique<odometry::PlaneOdometry>(options.planes);
}
}  // namespace delio
