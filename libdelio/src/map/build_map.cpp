#include "build_map.h"

#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <chrono>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/stopwatch.h"
#include "spooled_scan.h"
#include "surfaces_about.h"
#include "visibility_votes.h"
#include "voxel_set.h"

namespace delio::map {
using Eigen::Isometry3d;

namespace {
const Isometry3d& poseOf(const StoredScan& scan, const std::vector<Isometry3d>& poses) {
    if (scan.poseIndex >= poses.size())
        throw Error("the map needs pose " + std::to_string(scan.poseIndex) +
                    ", but there are only " + std::to_string(poses.size()) + " poses");
    return poses[scan.poseIndex];
}

Eigen::Vector3d pointAt(const float* floats) {
    return {double{floats[0]}, double{floats[1]}, double{floats[2]}};
}

/** What all scans say of what was seen. */
std::shared_ptr<const VisibilityVotes> votesOf(const MapParts& parts,
                                               const std::vector<Isometry3d>& poses) {
    auto votes = std::make_shared<VisibilityVotes>(parts.options.removal);
    for (std::size_t i = 0; i < parts.scans.size(); ++i) {
        const StoredScan& scan = parts.scans[i];
        const Isometry3d sensorInWorld = poseOf(scan, poses) * scan.sensorPose;
        const auto floats = parts.spool->read(scan.points);
        for (std::size_t k = 0; 4 * k < floats.size(); ++k)
            votes->hit(sensorInWorld * pointAt(&floats[4 * k]), k >= scan.still,
                       static_cast<std::uint32_t>(i));
    }
    if (!parts.options.removal.enabled) return votes;
    // What is far away stays in view for long: every other scan will do.
    constexpr float kFar_m = 60, kNear_m = 35;
    bool farToo = false;
    for (const StoredScan& scan : parts.scans) {
        if (scan.view.floats == 0) continue;
        farToo = !farToo;
        votes->look({readView(scan, *parts.spool), parts.options.removal.cell_deg},
                    poseOf(scan, poses) * scan.sensorPose, farToo ? kFar_m : kNear_m);
    }
    votes->decide();
    return votes;
}

/** Sorts the points of scan after scan into what stands still and what does not. */
class Sorter {
 public:
    Sorter(const MapParts& parts, const VisibilityVotes& votes)
        : parts_(parts),
          votes_(votes),
          stillVoxels_(parts.options.voxelSize_m),
          dynamicVoxels_(parts.options.voxelSize_m) {}

    void add(const StoredScan& scan, const Isometry3d& sensorInWorld) {
        const auto floats = parts_.spool->read(scan.points);
        const std::chrono::duration<double> since = scan.stamp - parts_.scans.front().stamp;
        MapPoint point;
        point.time_s = static_cast<float>(since.count());
        for (std::size_t k = 0; 4 * k < floats.size(); ++k) {
            const Eigen::Vector3d at = sensorInWorld * pointAt(&floats[4 * k]);
            const bool isDynamic = votes_.isDynamic(at);
            const bool wasToldToMove = k >= scan.still;
            // Told to move where most scans say that something stands: these are kept.
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
}  // namespace delio::map
