#include "delio/map/map_builder.h"

#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "spooled_scan.h"
#include "voxel_set.h"

namespace delio::map {
using Eigen::Isometry3d;
using mrpt::maps::CPointsMap;
using mrpt::maps::CPointsMapXYZI;

namespace {
constexpr double kDeg = M_PI / 180;

const Isometry3d& poseOf(std::size_t index, const std::vector<Isometry3d>& poses) {
    if (index >= poses.size())
        throw Error("the map needs pose " + std::to_string(index) + ", but there are only " +
                    std::to_string(poses.size()) + " poses");
    return poses[index];
}
}  // namespace

std::vector<OptionField> MapOptions::fields() const {
    return {
        {"keyframe_distance", &MapOptions::keyframeDistance_m, "a keyframe every so many metres", 0,
         1e6},
        {"keyframe_angle_deg", &MapOptions::keyframeAngle_deg,
         "and after every turn by so many degrees", 0, 360},
        {"voxel_size", &MapOptions::voxelSize_m,
         "edge in metres of the voxels of which one point is kept; 0 keeps every point", 0, 1e3},
        {"min_range", &MapOptions::minRange_m,
         "metres; points nearer to the sensor (the car itself) are left out", 0, 1e6},
        {"max_range", &MapOptions::maxRange_m,
         "metres; points farther from the sensor are left out", 0, 1e6},
    };
}

void MapOptions::check(const std::string& section) const {
    requireOrder(section + ".min_range", minRange_m, section + ".max_range", maxRange_m);
}

struct MapBuilder::Keyframe {
    std::size_t poseIndex = 0;
    Isometry3d sensorPose = Isometry3d::Identity();
    mrpt::Clock::time_point stamp;
    bool withIntensity = false;
    io::Spool::Place points;
};

/** A scan's points, their place, and which of them move. */
struct MapBuilder::Input {
    const CPointsMap& points;
    const CPointsMapXYZI* withIntensity;  //!< the same points; null where there is none
    const Isometry3d& sensorInWorld;
    const std::vector<std::uint8_t>& moving;
};

MapBuilder::MapBuilder(const MapOptions& options, std::string sensorLabel, std::string folder)
    : options_(options),
      sensorLabel_(std::move(sensorLabel)),
      folder_(std::move(folder)),
      seen_(std::make_unique<VoxelSet>(options.voxelSize_m)) {}

MapBuilder::~MapBuilder() = default;
MapBuilder::MapBuilder(MapBuilder&&) noexcept = default;
MapBuilder& MapBuilder::operator=(MapBuilder&&) noexcept = default;

std::size_t MapBuilder::keyframes() const { return keyframes_.size(); }

bool MapBuilder::isFarFromLastKeyframe(const Isometry3d& pose) const {
    const Eigen::Vector3d moved = pose.translation() - lastKeyPose_.translation();
    const Eigen::Matrix3d turned = lastKeyPose_.linear().transpose() * pose.linear();
    return moved.norm() >= options_.keyframeDistance_m ||
           angleOf(turned) >= options_.keyframeAngle_deg * kDeg;
}

io::Spool::Floats MapBuilder::sift(const Input& scan, bool isKeyframe, std::vector<Point>& fresh) {
    const auto& x = scan.points.getPointsBufferRef_x();
    const auto& y = scan.points.getPointsBufferRef_y();
    const auto& z = scan.points.getPointsBufferRef_z();
    // Room for all, so that no point can be lost whose voxel is taken already.
    fresh.reserve(x.size());
    VoxelSet ofThisScan(options_.voxelSize_m);
    io::Spool::Floats whole;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::Vector3d p(double{x[i]}, double{y[i]}, double{z[i]});
        const double range = p.norm();
        // Written so that a NaN is left out as well.
        const bool usable = range >= options_.minRange_m && range <= options_.maxRange_m;
        if (!usable || (!scan.moving.empty() && scan.moving[i])) continue;
        const float intensity =
            scan.withIntensity ? scan.withIntensity->getPointIntensity_fast(i) : 0;
        if (isKeyframe && ofThisScan.insert(p))
            whole.insert(whole.end(), {x[i], y[i], z[i], intensity});
        if (seen_->insert(scan.sensorInWorld * p)) fresh.push_back({x[i], y[i], z[i], intensity});
    }
    fresh.shrink_to_fit();
    return whole;
}

void MapBuilder::keep(Keyframe keyframe, const io::Spool::Floats& points) {
    try {
        if (!spool_) spool_ = std::make_shared<io::Spool>(folder_, "keyframes", "--no-map");
        keyframe.points = spool_->append(points);
    } catch (const Error& e) {
        spoolFault_ = e.what();
        last_.spoolFault = true;
        return;
    }
    keyframes_.push_back(keyframe);
    last_.keyframe = true;
}

bool MapBuilder::add(std::size_t poseIndex, const Isometry3d& approximatePose,
                     const CPointsMap& sensorPoints, const Isometry3d& sensorPose,
                     mrpt::Clock::time_point stamp, const std::vector<std::uint8_t>& moving) {
    const bool isKeyframe =
        spoolFault_.empty() && (keyframes_.empty() || isFarFromLastKeyframe(approximatePose));
    last_ = {};
    last_.sensorInWorld = approximatePose * sensorPose;
    last_.keyPoseBefore = lastKeyPose_;
    const auto* withIntensity = dynamic_cast<const CPointsMapXYZI*>(&sensorPoints);
    try {
        scans_.push_back({poseIndex, sensorPose, {}});
        last_.points = true;
        const auto whole = sift({sensorPoints, withIntensity, last_.sensorInWorld, moving},
                                isKeyframe, scans_.back().points);
        if (!whole.empty())
            keep({poseIndex, sensorPose, stamp, withIntensity != nullptr, {}}, whole);
    } catch (...) {
        undo();
        throw;
    }
    if (scans_.back().points.empty()) {
        scans_.pop_back();
        last_.points = false;
    }
    if (last_.keyframe) lastKeyPose_ = approximatePose;
    return last_.keyframe;
}

void MapBuilder::undo() noexcept {
    if (last_.points) {
        for (const Point& p : scans_.back().points)
            seen_->erase(last_.sensorInWorld *
                         Eigen::Vector3d(double{p.x}, double{p.y}, double{p.z}));
        scans_.pop_back();
    }
    // Its points stay on the disk: a simplemap that was given out may still need them.
    if (last_.keyframe) {
        keyframes_.pop_back();
        lastKeyPose_ = last_.keyPoseBefore;
    }
    if (last_.spoolFault) spoolFault_.clear();
    last_ = {};
}

mrpt::maps::CSimpleMap MapBuilder::simplemap(const std::vector<Isometry3d>& poses) const {
    if (!spoolFault_.empty()) throw Error(spoolFault_);
    mrpt::maps::CSimpleMap map;
    for (const auto& keyframe : keyframes_) {
        auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
        pose->mean = toMrpt(poseOf(keyframe.poseIndex, poses));
        auto observation =
            std::make_shared<SpooledScan>(spool_, keyframe.points, keyframe.withIntensity);
        observation->sensorLabel = sensorLabel_;
        observation->timestamp = keyframe.stamp;
        observation->sensorPose = toMrpt(keyframe.sensorPose);
        auto frame = mrpt::obs::CSensoryFrame::Create();
        frame->insert(observation);
        map.insert(pose, frame);
    }
    return map;
}

std::vector<Isometry3d> MapBuilder::keyPoses(const std::vector<Isometry3d>& poses) const {
    std::vector<Isometry3d> result;
    for (const auto& keyframe : keyframes_) result.push_back(poseOf(keyframe.poseIndex, poses));
    return result;
}

CPointsMapXYZI MapBuilder::points(const std::vector<Isometry3d>& poses) const {
    std::size_t most = 0;
    for (const auto& scan : scans_) most += scan.points.size();
    CPointsMapXYZI map;
    map.reserve(most);
    VoxelSet taken(options_.voxelSize_m);
    for (const auto& scan : scans_) {
        const Isometry3d sensorInWorld = poseOf(scan.poseIndex, poses) * scan.sensorPose;
        for (const Point& p : scan.points) {
            const Eigen::Vector3d at =
                sensorInWorld * Eigen::Vector3d(double{p.x}, double{p.y}, double{p.z});
            if (taken.insert(at))
                map.insertPointRGB(static_cast<float>(at.x()), static_cast<float>(at.y()),
                                   static_cast<float>(at.z()), p.intensity, 0, 0);
        }
    }
    return map;
}
}  // namespace delio::map
