#include "delio/slam.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/system/CTicTac.h>

#include <Eigen/Dense>

namespace delio {
using mrpt::poses::CPose3D;

namespace {
/** An increment of the sensor as one of the vehicle: S_from D S_to^-1. Its covariance moves from
 *  the sensor's frame to the vehicle's by the adjoint of S_to. */
Increment ofVehicle(const Increment& ofSensor, const CPose3D& sensorFrom, const CPose3D& sensorTo) {
    Increment result;
    result.pose = sensorFrom + ofSensor.pose + (-sensorTo);
    const Eigen::Matrix3d R = sensorTo.getRotationMatrix().asEigen();
    Eigen::Matrix3d lever;
    lever << 0, -sensorTo.z(), sensorTo.y(), sensorTo.z(), 0, -sensorTo.x(), -sensorTo.y(),
        sensorTo.x(), 0;
    Eigen::Matrix<double, 6, 6> adjoint = Eigen::Matrix<double, 6, 6>::Zero();
    adjoint << R, lever * R, Eigen::Matrix3d::Zero(), R;
    const Eigen::Matrix<double, 6, 6> covariance =
        adjoint * ofSensor.covariance.asEigen() * adjoint.transpose();
    result.covariance = mrpt::math::CMatrixDouble66(
        Eigen::Matrix<double, 6, 6>((covariance + covariance.transpose()) / 2));
    return result;
}

/** The points that were used, with the intensities that the scan came with. */
mrpt::maps::CPointsMap::Ptr pointsForMap(const Scan& scan, const UsedPoints& used) {
    using mrpt::maps::CPointsMapXYZI;
    const auto* bright = dynamic_cast<const CPointsMapXYZI*>(scan.points.get());
    mrpt::maps::CPointsMap::Ptr points = mrpt::maps::CSimplePointsMap::Create();
    if (bright) points = CPointsMapXYZI::Create();
    points->reserve(used.indices.size());
    for (std::size_t i = 0; i < used.indices.size(); ++i) {
        const Eigen::Vector3f p = used.points.col(static_cast<Eigen::Index>(i));
        if (bright)
            points->insertPointRGB(p.x(), p.y(), p.z(),
                                   bright->getPointIntensity_fast(used.indices[i]), 0, 0);
        else
            points->insertPointFast(p.x(), p.y(), p.z());
    }
    return points;
}
}  // namespace

Slam::Slam(const Options& options, bool withGraph, bool withMap, const std::string& sensorLabel,
           const std::string& folder)
    : options_(options),
      withGraph_(withGraph),
      withMap_(withMap),
      odometry_(options.odometry),
      map_(options.map, sensorLabel, folder) {}

ScanReport Slam::process(const Scan& scan) {
    ScanReport report{scan.index, scan.stamp_s, odometry_.process(scan), 0, 0};
    auto& poses = odometryTrajectory_.poses;
    Recent latest{poses.size(), report.odometry.features, scan.sensorPose};
    if (recent_.empty()) {
        poses.emplace_back();
        graph_.addNode(poses.back());
    } else {
        const Increment increment =
            ofVehicle(report.odometry.increment, recent_.front().sensorPose, scan.sensorPose);
        poses.push_back(poses.back() + increment.pose);
        graph_.addNode(graph_.poses().back() + increment.pose);
        graph_.addEdge({latest.node - 1, latest.node, increment});
    }
    odometryTrajectory_.stamps_s.push_back(scan.stamp_s);
    // Where a scan was taken that could not be registered is a guess.
    if (withMap_ && !report.odometry.predicted) {
        mrpt::system::CTicTac clock;
        map_.add(latest.node, poses.back(), *pointsForMap(scan, report.odometry.used),
                 scan.sensorPose, scan.time, report.odometry.used.moving);
        report.map_ms = 1e3 * clock.Tac();
    }
    if (withGraph_ && !report.odometry.predicted && report.odometry.features) {
        mrpt::system::CTicTac clock;
        const std::size_t before = graph_.edges().size();
        addSkipEdges(latest);
        // The chain alone is what the poses were made of: nothing to optimise.
        if (options_.graph.window > 0 && graph_.edges().size() > before)
            graph_.optimiseLast(options_.graph.window, options_.graph);
        report.graph_ms = 1e3 * clock.Tac();
    }
    recent_.push_front(latest);
    if (recent_.size() > options_.graph.skip_edges + 1) recent_.pop_back();
    return report;
}

void Slam::addSkipEdges(const Recent& latest) {
    const auto& poses = graph_.poses();
    for (std::size_t i = 1; i < recent_.size(); ++i) {
        const Recent& earlier = recent_[i];
        const CPose3D guess = (-(poses[earlier.node] + earlier.sensorPose)) +
                              (poses[latest.node] + latest.sensorPose);
        StageTimes unused{};
        const Registration registration =
            odometry_.align(*earlier.features, *latest.features, guess, 0, unused);
        // Where a scan did not register there is nothing to learn beyond the prediction.
        if (!registration.predictedReason.empty()) continue;
        if (registration.translation.overlap < options_.graph.min_overlap) break;
        graph_.addEdge({earlier.node, latest.node,
                        ofVehicle(registration.increment, earlier.sensorPose, latest.sensorPose)});
    }
}

graph::OptimisationResult Slam::optimise() {
    return withGraph_ ? graph_.optimise(options_.graph) : graph::OptimisationResult{};
}

io::Trajectory Slam::trajectory() const { return {graph_.poses(), odometryTrajectory_.stamps_s}; }
}  // namespace delio
