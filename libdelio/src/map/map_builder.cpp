#include "delio/map/map_builder.h"

#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/Lie/SO.h>

#include <filesystem>

#include "delio/error.h"
#include "spooled_scan.h"
#include "voxel_set.h"

namespace delio::map {
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;
using mrpt::poses::CPose3D;

namespace {
double angleBetween_deg(const CPose3D& a, const CPose3D& b) {
    const auto rotation = (b - a).getRotationMatrix();
    return mrpt::RAD2DEG(mrpt::poses::Lie::SO<3>::log(rotation).norm());
}

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

struct MapBuilder::KeyScan {
    std::size_t poseIndex = 0;
    CPose3D sensorPose;
    mrpt::Clock::time_point stamp;
    bool withIntensity = false;
    ScanSpool::Place points;
};

MapBuilder::MapBuilder(const MapOptions& options, std::string sensorLabel, std::string folder)
    : options_(options),
      sensorLabel_(std::move(sensorLabel)),
      folder_(std::move(folder)),
      seen_(std::make_unique<VoxelSet>(options.voxelSize_m)) {}

MapBuilder::~MapBuilder() = default;
MapBuilder::MapBuilder(MapBuilder&&) noexcept = default;
MapBuilder& MapBuilder::operator=(MapBuilder&&) noexcept = default;

std::size_t MapBuilder::keyScans() const { return keyScans_.size(); }

bool MapBuilder::add(std::size_t poseIndex, const CPose3D& approximatePose,
                     const CPointsMap& sensorPoints, const CPose3D& sensorPose,
                     mrpt::Clock::time_point stamp, const std::vector<std::uint8_t>& moving) {
    const auto farFromLast = [&] {
        return approximatePose.distanceTo(lastKeyPose_) >= options_.keyframeDistance_m ||
               angleBetween_deg(lastKeyPose_, approximatePose) >= options_.keyframeAngle_deg;
    };
    const bool isKeyScan = spoolFault_.empty() && (keyScans_.empty() || farFromLast());
    const Eigen::Matrix4d toWorld = (approximatePose + sensorPose)
                                        .getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>()
                                        .asEigen();
    const Eigen::Matrix3d R = toWorld.topLeftCorner<3, 3>();
    const Eigen::Vector3d t = toWorld.topRightCorner<3, 1>();

    const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(&sensorPoints);
    const auto& x = sensorPoints.getPointsBufferRef_x();
    const auto& y = sensorPoints.getPointsBufferRef_y();
    const auto& z = sensorPoints.getPointsBufferRef_z();
    VoxelSet ofThisScan(options_.voxelSize_m);
    std::vector<Point> fresh;
    ScanSpool::Floats whole;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::Vector3d p(double{x[i]}, double{y[i]}, double{z[i]});
        const double range = p.norm();
        // Written so that a NaN is left out as well.
        const bool usable = range >= options_.minRange_m && range <= options_.maxRange_m;
        if (!usable || (!moving.empty() && moving[i])) continue;
        const float intensity = withIntensity ? withIntensity->getPointIntensity_fast(i) : 0;
        if (isKeyScan && ofThisScan.insert(p))
            whole.insert(whole.end(), {x[i], y[i], z[i], intensity});
        if (seen_->insert(R * p + t)) fresh.push_back({x[i], y[i], z[i], intensity});
    }
    fresh.shrink_to_fit();
    if (!fresh.empty()) scans_.push_back({poseIndex, sensorPose, std::move(fresh)});
    if (whole.empty()) return false;
    try {
        if (!spool_)
            spool_ = std::make_shared<ScanSpool>(
                folder_.empty() ? std::filesystem::temp_directory_path().string() : folder_);
        keyScans_.push_back(
            {poseIndex, sensorPose, stamp, withIntensity != nullptr, spool_->append(whole)});
    } catch (const Error& e) {
        spoolFault_ = e.what();
        return false;
    }
    lastKeyPose_ = approximatePose;
    return true;
}

mrpt::maps::CSimpleMap MapBuilder::simplemap(const std::vector<CPose3D>& poses) const {
    if (!spoolFault_.empty()) throw Error(spoolFault_);
    mrpt::maps::CSimpleMap map;
    for (const auto& scan : keyScans_) {
        auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
        pose->mean = poseOf(scan.poseIndex, poses);
        auto observation = std::make_shared<SpooledScan>(spool_, scan.points, scan.withIntensity);
        observation->sensorLabel = sensorLabel_;
        observation->timestamp = scan.stamp;
        observation->sensorPose = scan.sensorPose;
        auto frame = mrpt::obs::CSensoryFrame::Create();
        frame->insert(observation);
        map.insert(pose, frame);
    }
    return map;
}

std::vector<CPose3D> MapBuilder::keyPoses(const std::vector<CPose3D>& poses) const {
    std::vector<CPose3D> result;
    for (const auto& scan : keyScans_) result.push_back(poseOf(scan.poseIndex, poses));
    return result;
}

CPointsMapXYZI MapBuilder::points(const std::vector<CPose3D>& poses) const {
    std::size_t most = 0;
    for (const auto& scan : scans_) most += scan.points.size();
    CPointsMapXYZI map;
    map.reserve(most);
    VoxelSet taken(options_.voxelSize_m);
    for (const auto& scan : scans_) {
        const CPose3D sensorInWorld = poseOf(scan.poseIndex, poses) + scan.sensorPose;
        for (const Point& p : scan.points) {
            Eigen::Vector3d at;
            sensorInWorld.composePoint(double{p.x}, double{p.y}, double{p.z}, at.x(), at.y(),
                                       at.z());
            if (taken.insert(at))
                map.insertPointRGB(static_cast<float>(at.x()), static_cast<float>(at.y()),
                                   static_cast<float>(at.z()), p.intensity, 0, 0);
        }
    }
    return map;
}
}  // namespace delio::map
