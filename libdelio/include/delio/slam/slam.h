#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delio/formats/trajectory.h"
#include "delio/graph/pose_graph.h"
#include "delio/odometry/odometry.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/step.h"

namespace delio {
/** Poses kept: of all scans, or only of the last one, so that memory does not grow with the drive.
 */
enum class History { All, Last };

/** Pose of a node: vehicle to world. */
using NodePose = graph::NodePose;

/** One scan as Slam passes it to its listeners. References are valid during the call. */
struct SlamScan {
    std::size_t node;  //!< number of its pose, from 0
    const Scan& scan;  //!< as read
    const Step& step;  //!< result of the odometry
    /** Of the vehicle, since the scan before; identity for the first. */
    Increment increment;
    /** Of the vehicle, by the odometry alone: maps its coordinates to those it had at the first
     *  scan. */
    Eigen::Isometry3d pose;
    /** The same of earlier scans whose poses this one corrects (Step::corrected). */
    std::vector<NodePose> corrected = {};
    /** Where one of these is the scan before, and what it saw stays in place: maps the vehicle's
     *  coordinates at its old pose to those at its new one. */
    std::optional<Eigen::Isometry3d> fromOldPose = {};
};

/** Static points of a scan, in the vehicle's frame: at most 20 000, as several scans are merged. */
Eigen::Matrix3Xf staticPoints(const SlamScan& scan);

/** Consumer of an odometry's steps: a pose graph, a map, a window. */
class SlamListener {
 public:
    virtual ~SlamListener() = default;

    /** Name of its time in scans.csv, and of the listener in messages. */
    virtual const char* name() const = 0;

    /** Takes the next scan. A listener that throws gets no more scans (ScanReport::failed). */
    virtual void add(const SlamScan& scan) = 0;
};

/** A listener that threw, and its message. */
struct FailedListener {
    std::shared_ptr<const SlamListener> listener;  //!< that was switched off
    std::string message;                           //!< one plain line
};

/** Result of one scan. */
struct ScanReport {
    Step step;                           //!< of the odometry
    std::vector<Named> listeners_ms;     //!< time of each listener, under its name
    std::vector<FailedListener> failed;  //!< listeners that were switched off at this scan
};

/** An odometry and its listeners: each listener is called with every step in turn. Poses are the
 *  vehicle's: they map its coordinates to those it had at the first scan. */
class Slam {
 public:
    /** Without listeners yet. `history`: which poses trajectory() keeps. */
    explicit Slam(std::unique_ptr<Odometry> odometry, History history = History::All)
        : odometry_(std::move(odometry)), history_(history) {}

    /** Attaches a listener, which is called from the next scan on, after the earlier ones. */
    void attach(std::shared_ptr<SlamListener> listener);

    /** A listener that throws is switched off: it gets no more scans, the others and the odometry
     *  continue, and the report names it. Where the odometry throws, or gives an increment that is
     *  not finite, which is an Error, trajectory and listeners are as they were before. */
    ScanReport process(const Scan& scan);

    /** See Odometry::settle(). */
    void settle();

    /** Takes a sample of the drive's IMU: see Odometry::addImu(). */
    void addImu(const ImuSample& sample);

    /** What the odometry found out about the IMU so far: see Odometry::imuReport(). */
    std::optional<ImuReport> imuReport() const;
    /** Takes a pose by the drive's wheels: see Odometry::addOdometry(). */
    void addOdometry(const OdometrySample& sample);
    /** See Odometry::odometryReport(). */
    std::optional<OdometryReport> odometryReport() const;
    /** See Odometry::ownVehicle(). */
    Eigen::AlignedBox3d ownVehicle() const;

    /** Ends the drive and frees the odometry. process() is an Error from then on. */
    void close() { odometry_.reset(); }

    /** Of the odometry alone: the poses of all scans, or the last one (see History). */
    const io::Trajectory& trajectory() const { return trajectory_; }

 private:
    void requireOpen() const;
    void tell(const SlamScan& scan, ScanReport& report);

    std::unique_ptr<Odometry> odometry_;
    std::vector<std::shared_ptr<SlamListener>> listeners_;
    History history_;
    io::Trajectory trajectory_;
    std::size_t nodes_ = 0;  //!< scans that were taken
    /** Sensor in the vehicle at each of the latest scans. */
    std::deque<Eigen::Isometry3d> sensorPoses_;
};
}  // namespace delio
