#include "delio/map/map_builder.h"

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/Lie/SO.h>

#include <cmath>
#include <unordered_set>

#include "delio/error.h"
#include "delio/scan/voxel_grid.h"

namespace delio::map {
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;
using mrpt::maps::CSimplePointsMap;
using mrpt::poses::CPose3D;

namespace {
double angleBetween_deg(const CPose3D& a, const CPose3D& b) {
    const auto rotation = (b - a).getRotationMatrix();
    return mrpt::RAD2DEG(mrpt::poses::Lie::SO<3>::log(rotation).norm());
}

/** Lets through the first point of each voxel; every point if the size is 0. */
class Thinning {
 public:
    explicit Thinning(double voxelSize_m) : voxelSize_m_(voxelSize_m) {}
    bool keeps(double x, double y, double z) {
        return voxelSize_m_ == 0 || taken_.insert(scan::voxelKey({x, y, z}, voxelSize_m_)).second;
    }

 private:
    double voxelSize_m_;
    std::unordered_set<std::uint64_t> taken_;
};

const CPose3D& poseOf(std::size_t index, const std::vector<CPose3D>& poses) {
    if (index >= poses.size())
        throw Error("the map needs pose " + std::to_string(index) + ", but there are only " +
                    std::to_string(poses.size()) + " poses");
    return poses[index];
}
}  // namespace

std::vector<OptionField> MapOptions::fields() {
    return {
        {"keyframe_distance", &keyframeDistance_m, "a key scan every so many metres", 0, 1e6},
        {"keyframe_angle_deg", &keyframeAngle_deg, "and after every turn by so many degrees", 0,
         360},
        {"voxel_size", &voxelSize_m,
         "edge in metres of the voxels of which one point is kept; 0 keeps every point", 0, 1e3},
        {"min_range", &minRange_m,
         "metres; points nearer to the sensor (the car itself) are left out", 0, 1e6},
        {"max_range", &maxRange_m, "metres; points farther from the sensor are left out", 0, 1e6},
    };
}

MapBuilder::MapBuilder(const MapOptions& options, std::string sensorLabel)
    : options_(options), sensorLabel_(std::move(sensorLabel)) {}

bool MapBuilder::add(std::size_t poseIndex, const CPose3D& approximatePose,
                     const CPointsMap& sensorPoints, const CPose3D& sensorPose,
                     mrpt::Clock::time_point stamp) {
    const auto farFromLast = [&] {
        return approximatePose.distanceTo(lastKeyPose_) >= options_.keyframeDistance_m ||
               angleBetween_deg(lastKeyPose_, approximatePose) >= options_.keyframeAngle_deg;
    };
    if (!keyScans_.empty() && !farFromLast()) return false;

    const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(&sensorPoints);
    CPointsMap::Ptr kept;
    if (withIntensity)
        kept = CPointsMapXYZI::Create();
    else
        kept = CSimplePointsMap::Create();
    const auto& x = sensorPoints.getPointsBufferRef_x();
    const auto& y = sensorPoints.getPointsBufferRef_y();
    const auto& z = sensorPoints.getPointsBufferRef_z();
    Thinning thinning(options_.voxelSize_m);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double range = std::hypot(double{x[i]}, double{y[i]}, double{z[i]});
        // Written so that a NaN is left out as well.
        const bool usable = range >= options_.minRange_m && range <= options_.maxRange_m;
        if (!usable || !thinning.keeps(x[i], y[i], z[i])) continue;
        if (withIntensity)
            kept->insertPointRGB(x[i], y[i], z[i], withIntensity->getPointIntensity_fast(i), 0, 0);
        else
            kept->insertPointFast(x[i], y[i], z[i]);
    }
    if (kept->empty()) return false;
    kept->mark_as_modified();
    lastKeyPose_ = approximatePose;
    keyScans_.push_back({poseIndex, sensorPose, stamp, kept});
    return true;
}

mrpt::maps::CSimpleMap MapBuilder::simplemap(const std::vector<CPose3D>& poses) const {
    mrpt::maps::CSimpleMap map;
    for (const auto& scan : keyScans_) {
        auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
        pose->mean = poseOf(scan.poseIndex, poses);
        auto observation = mrpt::obs::CObservationPointCloud::Create();
        observation->sensorLabel = sensorLabel_;
        observation->timestamp = scan.stamp;
        observation->sensorPose = scan.sensorPose;
        observation->pointcloud = scan.points;
        auto frame = mrpt::obs::CSensoryFrame::Create();
        frame->insert(observation);
        map.insert(pose, frame);
    }
    return map;
}

CPointsMapXYZI MapBuilder::points(const std::vector<CPose3D>& poses) const {
    CPointsMapXYZI map;
    Thinning thinning(options_.voxelSize_m);
    for (const auto& scan : keyScans_) {
        const CPose3D sensorInWorld = poseOf(scan.poseIndex, poses) + scan.sensorPose;
        const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(scan.points.get());
        const auto& xs = scan.points->getPointsBufferRef_x();
        const auto& ys = scan.points->getPointsBufferRef_y();
        const auto& zs = scan.points->getPointsBufferRef_z();
        for (std::size_t i = 0; i < xs.size(); ++i) {
            double x, y, z;
            sensorInWorld.composePoint(double{xs[i]}, double{ys[i]}, double{zs[i]}, x, y, z);
            if (!thinning.keeps(x, y, z)) continue;
            map.insertPointRGB(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                               withIntensity ? withIntensity->getPointIntensity_fast(i) : 0, 0, 0);
        }
    }
    return map;
}
}  // namespace delio::map
