#include "map/build_map.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "core/principal_axes.h"
#include "core/voxel_table.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/stopwatch.h"
#include "map/motion_labels.h"
#include "map/stored_scan.h"
#include "map/visibility_votes.h"
#include "map/voxel_set.h"

namespace delio::map {
using Eigen::Isometry3d;

namespace {
using Voxel = Eigen::Array3i;

/** The first point of each voxel, found by its place. */
class FirstPoints {
 public:
    FirstPoints(const MapPoints& points, double size) : size_(size) {
        firsts_.reserve(points.size());
        index_.reserve(points.size());
        for (std::uint32_t i = 0; i < points.size(); ++i)
            if (index_.insert(keyOf(voxelOf(points[i]))) == firsts_.size()) firsts_.push_back(i);
    }

    Voxel voxelOf(const MapPoint& point) const {
        return (point.position.cast<double>().array() / size_).floor().cast<int>();
    }

    template <typename Visit>
    void forNeighbours(const Voxel& voxel, const Visit& visit) const {
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y)
                for (int z = -1; z <= 1; ++z) {
                    const auto number = index_.find(keyOf(voxel + Voxel(x, y, z)));
                    if (number != VoxelIndex::kNone) visit(firsts_[number]);
                }
    }

 private:
    static std::uint64_t keyOf(const Voxel& voxel) {
        const auto part = [](int v) {
            return static_cast<std::uint64_t>(static_cast<std::int64_t>(v)) & ((1U << 21) - 1);
        };
        return part(voxel.x()) << 42 | part(voxel.y()) << 21 | part(voxel.z());
    }

    double size_;
    VoxelIndex index_;
    std::vector<std::uint32_t> firsts_;
};

/** Gives each point the normal and the residual of the plane through the points about it (those in
 *  its voxel's neighbourhood, one a voxel of `spacing` metres; 0: of 0.2). Its normal says before
 *  towards which side it has to point; it is 0 afterwards where too few points are about. */
void findSurfaces(MapPoints& points, double spacing) {
    constexpr double kSpacing_m = 0.2;
    constexpr int kLeast = 5;
    // Points about a line, a pole or a single ring, have no normal.
    constexpr double kBroad = 0.05;
    const FirstPoints firsts(points, spacing > 0 ? spacing : kSpacing_m);
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        MapPoint& point = points[i];
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
        int count = 0;
        firsts.forNeighbours(firsts.voxelOf(point), [&](std::uint32_t other) {
            const Eigen::Vector3f d = points[other].position - point.position;
            sum += d;
            squares += d * d.transpose();
            ++count;
        });
        const Eigen::Vector3f towards = point.normal;
        point.normal.setZero();
        if (count < kLeast) return;
        const Eigen::Vector3f mean = sum / static_cast<float>(count);
        const Eigen::Matrix3f scatter =
            squares / static_cast<float>(count) - mean * mean.transpose();
        const auto [variances, axes] = principalAxes(scatter.cast<double>());
        if (!(variances[1] > kBroad * variances[2])) return;
        point.residual_m = static_cast<float>(std::sqrt(std::max(variances[0], 0.0)));
        point.normal = axes.col(0).cast<float>();
        if (point.normal.dot(towards) < 0) point.normal = -point.normal;
    });
}

/** A CObservationPointCloud whose points, without those that are dynamic, are fetched from the disk
 * while they are needed: a simplemap of such scans is written with one of them in memory at a time,
 * and what is written is a plain CObservationPointCloud with its points embedded. */
class SpooledScan : public mrpt::obs::CObservationPointCloud {
 public:
    SpooledScan(std::shared_ptr<const io::Spool> spool, const StoredScan& scan,
                const Eigen::Isometry3d& sensorInWorld,
                std::shared_ptr<const VisibilityVotes> votes)
        : spool_(std::move(spool)),
          place_(scan.stillPoints()),
          withIntensity_(scan.withIntensity),
          sensorInWorld_(sensorInWorld),
          votes_(std::move(votes)) {}

    void load() const override;
    void unload() const override;
    mrpt::rtti::CObject* clone() const override { return new SpooledScan(*this); }

 protected:
    void serializeTo(mrpt::serialization::CArchive& out) const override;

 private:
    std::shared_ptr<const io::Spool> spool_;
    io::Spool::Place place_;
    bool withIntensity_;
    Eigen::Isometry3d sensorInWorld_;
    std::shared_ptr<const VisibilityVotes> votes_;
};

void SpooledScan::load() const {
    if (pointcloud) return;
    const auto floats = spool_->read(place_);
    const auto withIntensity = withIntensity_ ? mrpt::maps::CPointsMapXYZI::Create() : nullptr;
    mrpt::maps::CPointsMap::Ptr cloud = withIntensity;
    if (!cloud) cloud = mrpt::maps::CSimplePointsMap::Create();
    cloud->reserve(floats.size() / 4);
    for (std::size_t i = 0; 4 * i < floats.size(); ++i) {
        const float* p = &floats[4 * i];
        if (votes_->isDynamic(sensorInWorld_ * Eigen::Vector3f(p[0], p[1], p[2]).cast<double>()))
            continue;
        if (withIntensity)
            withIntensity->insertPointRGB(p[0], p[1], p[2], p[3], 0, 0);
        else
            cloud->insertPointFast(p[0], p[1], p[2]);
    }
    cloud->mark_as_modified();
    // MRPT's own load() of scans that are stored elsewhere does the same to a const object.
    const_cast<SpooledScan*>(this)->pointcloud = cloud;
}

void SpooledScan::unload() const { const_cast<SpooledScan*>(this)->pointcloud.reset(); }

void SpooledScan::serializeTo(mrpt::serialization::CArchive& out) const {
    const bool wasLoaded = pointcloud != nullptr;
    load();
    CObservationPointCloud::serializeTo(out);
    if (!wasLoaded) unload();
}

const Isometry3d& poseOf(const StoredScan& scan, const std::vector<Isometry3d>& poses) {
    if (scan.poseIndex >= poses.size())
        throw Error("the map needs pose " + std::to_string(scan.poseIndex) +
                    ", but there are only " + std::to_string(poses.size()) + " poses");
    return poses[scan.poseIndex];
}

Eigen::Vector3d pointAt(const float* floats) {
    return {double{floats[0]}, double{floats[1]}, double{floats[2]}};
}

/** Asks the range images of all scans, or of those whose poses are `usable`. */
void look(const MapParts& parts, const std::vector<Isometry3d>& poses,
          const std::vector<bool>& usable, VisibilityVotes& votes) {
    // What is far away stays in view for long: every other scan will do.
    constexpr float kFar_m = 60, kNear_m = 35;
    bool farToo = false;
    for (const StoredScan& scan : parts.scans) {
        if (scan.view.floats == 0) continue;
        const Isometry3d& vehicle = poseOf(scan, poses);
        if (!usable.empty() && !usable[scan.poseIndex]) continue;
        farToo = !farToo;
        votes.look({readView(scan, *parts.spool), parts.options.removal.cell_deg},
                   vehicle * scan.sensorPose, farToo ? kFar_m : kNear_m);
    }
}

double seconds(mrpt::Clock::duration time) { return std::chrono::duration<double>(time).count(); }

Eigen::Matrix3Xf pointsOf(const std::vector<float>& floats) {
    return Eigen::Map<const Eigen::Matrix4Xf>(floats.data(), 4,
                                              static_cast<Eigen::Index>(floats.size() / 4))
        .topRows<3>();
}

/** Labels of moving points of each scan, found forward in time; empty if the scans have labels. */
std::vector<std::vector<std::uint8_t>> missingLabels(const MapParts& parts,
                                                     const std::vector<Isometry3d>& poses) {
    const bool isLabelled = std::any_of(parts.scans.begin(), parts.scans.end(),
                                        [](const StoredScan& scan) { return scan.isLabelled; });
    std::vector<std::vector<std::uint8_t>> all;
    if (isLabelled) return all;
    MotionLabels labels;
    for (const StoredScan& scan : parts.scans)
        all.push_back(labels.of(pointsOf(parts.spool->read(scan.points)),
                                poseOf(scan, poses) * scan.sensorPose,
                                seconds(scan.stamp - parts.scans.front().stamp)));
    return all;
}

/** Votes of all scans about the voxels. The scans are read backward in time: some objects show only
 *  in this direction that they move (see MotionLabels). */
std::shared_ptr<const VisibilityVotes> votesOf(const MapParts& parts,
                                               const std::vector<Isometry3d>& poses) {
    const bool isRemoving = parts.options.removal.enabled;
    auto votes = std::make_shared<VisibilityVotes>(parts.options.removal);
    std::vector<std::vector<std::uint8_t>> forward;
    if (isRemoving) forward = missingLabels(parts, poses);
    MotionLabels backward;
    for (std::size_t i = parts.scans.size(); i-- > 0;) {
        const StoredScan& scan = parts.scans[i];
        const Isometry3d sensorInWorld = poseOf(scan, poses) * scan.sensorPose;
        const auto floats = parts.spool->read(scan.points);
        std::vector<std::uint8_t> moving(floats.size() / 4);
        if (isRemoving)
            moving = backward.of(pointsOf(floats), sensorInWorld,
                                 seconds(parts.scans.front().stamp - scan.stamp));
        for (std::size_t k = 0; k < moving.size(); ++k)
            votes->hit(sensorInWorld * pointAt(&floats[4 * k]),
                       moving[k] || k >= scan.still || (!forward.empty() && forward[i][k]),
                       static_cast<std::uint32_t>(i));
    }
    if (!isRemoving) return votes;
    look(parts, poses, {}, *votes);
    votes->decide();
    return votes;
}

/** Sorts the points of each scan into static and dynamic ones. */
class Sorter {
 public:
    Sorter(const MapParts& parts, const VisibilityVotes& votes)
        : parts_(parts),
          votes_(votes),
          stillVoxels_(parts.options.voxelSize_m),
          dynamicVoxels_(parts.options.voxelSize_m) {}

    void add(const StoredScan& scan, const Isometry3d& sensorInWorld) {
        const auto floats = parts_.spool->read(scan.points);
        MapPoint point;
        point.time_s = static_cast<float>(seconds(scan.stamp - parts_.scans.front().stamp));
        for (std::size_t k = 0; 4 * k < floats.size(); ++k) {
            const Eigen::Vector3d at = sensorInWorld * pointAt(&floats[4 * k]);
            const bool isDynamic = votes_.isDynamic(at);
            const bool wasToldToMove = k >= scan.still;
            // Labelled as dynamic, but most scans hit this voxel as static: keep it.
            if (parts_.options.removal.enabled && wasToldToMove && !isDynamic) continue;
            const bool moves = isDynamic || wasToldToMove;
            if (!(moves ? dynamicVoxels_ : stillVoxels_).insert(at)) continue;
            point.position = at.cast<float>();
            point.intensity = floats[4 * k + 3];
            point.observations = votes_.observations(at);
            // Until the surface is known: from where the point was seen.
            point.normal = sensorInWorld.translation().cast<float>() - point.position;
            (moves ? dynamic : still).push_back(point);
        }
    }

    MapPoints still, dynamic;

 private:
    const MapParts& parts_;
    const VisibilityVotes& votes_;
    VoxelSet stillVoxels_, dynamicVoxels_;
};

void insertKeyframe(const MapParts& parts, const StoredScan& scan, const Isometry3d& vehicle,
                    const std::shared_ptr<const VisibilityVotes>& votes, BuiltMap& map) {
    auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
    pose->mean = toMrpt(vehicle);
    auto observation =
        std::make_shared<SpooledScan>(parts.spool, scan, vehicle * scan.sensorPose, votes);
    observation->sensorLabel = parts.sensorLabel;
    observation->timestamp = scan.stamp;
    observation->sensorPose = toMrpt(scan.sensorPose);
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(observation);
    map.simplemap.insert(pose, frame);
    map.keyPoses.push_back(vehicle);
}
}  // namespace

BuiltMap buildMap(const MapParts& parts, const std::vector<Isometry3d>& poses) {
    BuiltMap map;
    Stopwatch watch;
    const auto votes = votesOf(parts, poses);
    map.removal_ms = watch.lap_ms();
    Sorter sorter(parts, *votes);
    for (const StoredScan& scan : parts.scans) {
        const Isometry3d& vehicle = poseOf(scan, poses);
        sorter.add(scan, vehicle * scan.sensorPose);
        if (scan.isKeyframe) insertKeyframe(parts, scan, vehicle, votes, map);
    }
    map.points = std::move(sorter.still);
    map.dynamic = std::move(sorter.dynamic);
    findSurfaces(map.points, parts.options.voxelSize_m);
    findSurfaces(map.dynamic, parts.options.voxelSize_m);
    return map;
}

std::vector<std::uint8_t> seenThrough(const MapParts& parts, const std::vector<Isometry3d>& poses,
                                      const std::vector<bool>& usable,
                                      const Eigen::Matrix3Xf& points) {
    VisibilityVotes votes(parts.options.removal);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        votes.hit(points.col(i).cast<double>(), false, 0);
    look(parts, poses, usable, votes);
    votes.decide();
    std::vector<std::uint8_t> through(static_cast<std::size_t>(points.cols()));
    for (std::size_t i = 0; i < through.size(); ++i)
        through[i] = votes.isDynamic(points.col(static_cast<Eigen::Index>(i)).cast<double>());
    return through;
}
}  // namespace delio::map
