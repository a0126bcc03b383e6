#include "delio/map/map_builder.h"

#include <mrpt/maps/CPointsMapXYZI.h>

#include <chrono>
#include <filesystem>
#include <utility>

#include "build_map.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "stored_scan.h"
#include "voxel_set.h"

namespace delio::map {
using Eigen::Isometry3d;
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;

namespace {
constexpr double kDeg = M_PI / 180;
constexpr const char *kWhat = "scans for the map", *kOption = "--no-map";

/** Points used: first the static, then the dynamic ones, the first of each voxel. x y z intensity
 *  each. */
struct Thinned {
    io::Spool::Floats floats;
    std::size_t still = 0;
};

Thinned thinned(const CPointsMap& points, const Isometry3d& sensorInWorld,
                const std::vector<std::uint8_t>& moving, const MapOptions& options) {
    const auto& x = points.getPointsBufferRef_x();
    const auto& y = points.getPointsBufferRef_y();
    const auto& z = points.getPointsBufferRef_z();
    const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(&points);
    Thinned result;
    io::Spool::Floats movingFloats;
    VoxelSet stillVoxels(options.voxelSize_m), movingVoxels(options.voxelSize_m);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::Vector3d p(double{x[i]}, double{y[i]}, double{z[i]});
        const double range = p.norm();
        // Written so that a NaN is left out as well.
        const bool usable = range >= options.minRange_m && range <= options.maxRange_m;
        if (!usable) continue;
        const bool moves = !moving.empty() && moving[i];
        if (!(moves ? movingVoxels : stillVoxels).insert(sensorInWorld * p)) continue;
        auto& to = moves ? movingFloats : result.floats;
        to.insert(to.end(),
                  {x[i], y[i], z[i], withIntensity ? withIntensity->getPointIntensity_fast(i) : 0});
    }
    result.still = result.floats.size() / 4;
    result.floats.insert(result.floats.end(), movingFloats.begin(), movingFloats.end());
    return result;
}

Eigen::Matrix3Xf finitePoints(const CPointsMap& points) {
    const auto& x = points.getPointsBufferRef_x();
    const auto& y = points.getPointsBufferRef_y();
    const auto& z = points.getPointsBufferRef_z();
    Eigen::Matrix3Xf finite(3, x.size());
    Eigen::Index count = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::Vector3f p(x[i], y[i], z[i]);
        if (p.allFinite()) finite.col(count++) = p;
    }
    finite.conservativeResize(3, count);
    return finite;
}
}  // namespace

std::vector<OptionField> MapOptions::fields() const {
    return {
        {"keyframe_distance", &MapOptions::keyframeDistance_m, "m; distance between keyframes", 0,
         1e6},
        {"keyframe_angle_deg", &MapOptions::keyframeAngle_deg, "deg; rotation between keyframes", 0,
         360},
        {"voxel_size", &MapOptions::voxelSize_m,
         "m; voxel size of the map, one point per voxel; 0: keep every point; if not set: 0.2, in "
         "small places down to a quarter of that",
         0, 1e3},
        {"min_range", &MapOptions::minRange_m,
         "m; points closer to the sensor (the vehicle itself) are ignored; if not set: 2.5, in "
         "small places down to a quarter of that",
         0, 1e6},
        {"max_range", &MapOptions::maxRange_m, "m; points farther from the sensor are ignored", 0,
         1e6},
    };
}

void MapOptions::loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                                    const std::string& section) {
    StageOptions::loadFromConfigFile(source, section);
    voxelSizeIsSet_ = voxelSizeIsSet_ || source.keyExists(section, "voxel_size");
    minRangeIsSet_ = minRangeIsSet_ || source.keyExists(section, "min_range");
}

MapOptions MapOptions::atScale(double scale) const {
    const MapOptions standard;
    MapOptions scaled = *this;
    if (!voxelSizeIsSet_ && voxelSize_m == standard.voxelSize_m) scaled.voxelSize_m *= scale;
    if (!minRangeIsSet_ && minRange_m == standard.minRange_m) scaled.minRange_m *= scale;
    scaled.removal.margin_m *= scale;  // walls are near what moves in a room
    return scaled;
}

void MapOptions::check(const std::string& section) const {
    requireOrder(section + ".min_range", minRange_m, section + ".max_range", maxRange_m);
}

MapBuilder::MapBuilder(const MapOptions& options, std::string sensorLabel, std::string folder)
    : given_(options),
      options_(options),
      sensorLabel_(std::move(sensorLabel)),
      folder_(std::move(folder)) {}

MapBuilder::~MapBuilder() = default;
MapBuilder::MapBuilder(MapBuilder&&) noexcept = default;
MapBuilder& MapBuilder::operator=(MapBuilder&&) noexcept = default;

void MapBuilder::takeScale(double scale) {
    if (!scans_.empty()) return;
    scale_ = scale;
    options_ = given_.atScale(scale);
}

bool MapBuilder::isFarFromLastKeyframe(const Isometry3d& pose) const {
    const Eigen::Vector3d moved = pose.translation() - keyPose_.translation();
    const Eigen::Matrix3d turned = keyPose_.linear().transpose() * pose.linear();
    return moved.norm() >= options_.keyframeDistance_m ||
           angleOf(turned) >= options_.keyframeAngle_deg * kDeg;
}

/** A standing vehicle also sees objects come and go. */
bool MapBuilder::isFarFromLastView(const Isometry3d& pose, mrpt::Clock::time_point stamp) const {
    constexpr std::chrono::duration<double> kPause(0.45);  // stamps are rounded
    return views_ == 0 || stamp - viewStamp_ >= kPause ||
           (pose.translation() - viewPose_.translation()).norm() >= options_.removal.spacing_m;
}

void MapBuilder::putAside(const std::vector<float>& points, const CPointsMap* view,
                          StoredScan& scan) {
    if (!spool_) spool_ = std::make_shared<io::Spool>(folder_, kWhat, kOption);
    scan.points = spool_->append(points);
    if (!view) return;
    const auto packed =
        odometry::RangeImage(finitePoints(*view), options_.removal.cell_deg).packed();
    scan.viewFirstRow = packed.firstRow;
    scan.view = map::putAside(packed, *spool_);
}

bool MapBuilder::add(std::size_t poseIndex, const Isometry3d& approximatePose,
                     const CPointsMap& sensorPoints, const Isometry3d& sensorPose,
                     mrpt::Clock::time_point stamp, const std::vector<std::uint8_t>& moving) {
    const auto points = thinned(sensorPoints, approximatePose * sensorPose, moving, options_);
    if (points.floats.empty()) return false;
    StoredScan scan;
    scan.poseIndex = poseIndex;
    scan.sensorPose = sensorPose;
    scan.stamp = stamp;
    scan.withIntensity = dynamic_cast<const CPointsMapXYZI*>(&sensorPoints) != nullptr;
    scan.still = points.still;
    scan.isLabelled = !moving.empty();
    scan.isKeyframe = scan.still > 0 && (keyframes_ == 0 || isFarFromLastKeyframe(approximatePose));
    const bool isView = options_.removal.enabled && isFarFromLastView(approximatePose, stamp);
    putAside(points.floats, isView ? &sensorPoints : nullptr, scan);
    scans_.push_back(scan);
    if (scan.isKeyframe) {
        ++keyframes_;
        keyPose_ = approximatePose;
    }
    if (isView) {
        ++views_;
        viewPose_ = approximatePose;
        viewStamp_ = stamp;
    }
    return scan.isKeyframe;
}

void MapBuilder::keepInPlace(std::size_t poseIndex, const Isometry3d& fromOldPose) {
    if (scans_.empty() || scans_.back().poseIndex != poseIndex) return;
    scans_.back().sensorPose = fromOldPose * scans_.back().sensorPose;
}

BuiltMap MapBuilder::build(const std::vector<Isometry3d>& poses) const {
    return buildMap({scans_, spool_, options_, sensorLabel_}, poses);
}

std::vector<std::uint8_t> MapBuilder::seenThrough(const Eigen::Matrix3Xf& points,
                                                  const std::vector<Isometry3d>& poses,
                                                  const std::vector<bool>& usable) const {
    return map::seenThrough({scans_, spool_, options_, sensorLabel_}, poses, usable, points);
}
}  // namespace delio::map
