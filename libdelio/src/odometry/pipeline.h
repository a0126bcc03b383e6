#pragma once
#include <deque>
#include <optional>

#include "core/voxel_grid.h"
#include "delio/core/odometry_options.h"
#include "delio/odometry/odometry.h"
#include "odometry/arrivals.h"
#include "odometry/dynamic_objects.h"
#include "odometry/inertial.h"
#include "odometry/initial_guess.h"
#include "odometry/motion_model.h"
#include "odometry/own_vehicle.h"
#include "odometry/register_together.h"
#include "odometry/register_trajectory.h"
#include "odometry/tracking_state.h"
#include "odometry/wheel_prior.h"

namespace delio::odometry {
/** Points that wait to enter the map. */
struct PlacedPoints {
    Eigen::Matrix3Xf points;                                 //!< sensor's frame
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
};

/** A scan at its stamp. */
struct Stamped {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
    double stamp_s = 0;                                      //!< from the scan's time
    double time_s = 0;                                       //!< of the scan, since the start
};

/** Scan-to-map odometry, rotation and translation decoupled. A scan is preprocessed, predicted,
 *  de-skewed, registered to the points of earlier scans, freed of dynamic objects, and registered
 *  to the planes of earlier scans (LocalMap). Scans whose points have times are de-skewed twice: by
 *  the predicted motion, and by the motion that was found. Where three scans in a row that are not
 *  empty are not found in the map, a new map begins at the prediction. Poses are those at
 *  the scans' times (see countFromMiddle()), steps are those between the stamps. */
class PlaneOdometry : public Odometry {
 public:
    /** Before the first scan. */
    explicit PlaneOdometry(const PlaneOdometryOptions& options);

    Step process(const Scan& scan) override;
    void addImu(const ImuSample& sample) override { gyro_.add(sample); }
    std::optional<ImuReport> imuReport() const override { return gyro_.report(); }
    void addOdometry(const OdometrySample& sample) override { wheels_.add(sample); }
    std::optional<OdometryReport> odometryReport() const override { return wheels_.report(); }
    Eigen::AlignedBox3d ownVehicle() const override { return own_.box(); }

 private:
    void begin(const PointCloud& cloud, Step& step);
    void skip(const PointCloud& cloud, const Interval& interval, Step& step);
    void interrupt(double elapsed_s);

    /** A scan placed by points, from one guess of the motion. */
    struct Attempt {
        Eigen::Isometry3d predicted = Eigen::Isometry3d::Identity();  //!< sensor to map
        /** Where the motion of the scans before leads to. */
        Eigen::Isometry3d extrapolated = Eigen::Isometry3d::Identity();
        ScanTrajectory motion{Twist{}};  //!< that it was de-skewed by
        ScanView view;
        VoxelNumbers voxels;
        std::optional<DynamicObjects::Sight> sight;
        Placement placement;

        bool isBetterThan(const Attempt& other) const {
            const auto &mine = placement.estimate, &others = other.placement.estimate;
            return mine.valid && (!others.valid || mine.inlierRatio > others.inlierRatio);
        }
    };
    void track(const PointCloud& cloud, Attempt attempt, Step& step);
    Attempt attemptToTrack(const PointCloud& cloud, const Interval& interval, Step& step);
    Attempt attemptBy(const PointCloud& cloud, const Expectation& expected,
                      const ScanTrajectory& motion, Step& step);
    Attempt attemptAsPredicted(const PointCloud& cloud, double duration_s, double since_s,
                               bool timeIsKnown, Step& step);
    Attempt attemptAfterPause(const PointCloud& cloud, const Interval& interval, double since_s,
                              Step& step);

    // Scans that are registered together (pipeline_window.cpp).
    bool extendWindow(const PointCloud& cloud, double since_s, const Placement& found, Step& step);
    Attempt attemptInWindow(const PointCloud& cloud, double since_s, Step& step);
    Attempt attemptAgain(const PointCloud& cloud, double since_s, Attempt first, Step& step);
    void beginMapAgain();
    void settleWindow(const Step& step);
    void endWindow();
    void keep(PointCloud cloud, const Step& step);
    bool isSecondScan() const {
        const auto* first = std::get_if<FirstScan>(&state_);
        return first && first->skewed;
    }

    // The first scans of a map, once more (pipeline_retrace.cpp).
    struct Latest;
    void retraceStart(const PointCloud& cloud, const Step& step);
    void retrace(std::size_t count, std::size_t least);
    void turnBack(const PlaneOdometry& ahead, std::size_t first);
    std::optional<ScanTrajectory> stepBack(const Latest& scan);

    void advancePriors(const PointCloud& cloud, const Scan& scan) {
        advanceGyro(cloud, scan);
        advanceWheels(cloud, scan);
    }

    // The rotation by a gyroscope (pipeline_gyro.cpp).
    void advanceGyro(const PointCloud& cloud, const Scan& scan);
    std::optional<Attempt> attemptByGyro(const PointCloud& cloud, double duration_s, double since_s,
                                         Step& step);
    Attempt attemptWithGyro(const PointCloud& cloud, double duration_s, double since_s,
                            bool timeIsKnown, Step& step);
    std::optional<ScanTrajectory> trajectoryByGyro(const KnownEnds& known,
                                                   const PointCloud& cloud) const;
    void learnFromGyro(const Eigen::Isometry3d& predicted, double since_s);

    // The translation by wheels (pipeline_wheels.cpp).
    void advanceWheels(const PointCloud& cloud, const Scan& scan);
    Eigen::Isometry3d withWheels(const Eigen::Isometry3d& increment) const;
    Attempt attemptByWheels(const PointCloud& cloud, double duration_s, Attempt alone, Step& step);
    Eigen::Isometry3d predictedByWheels(const Eigen::Isometry3d& predicted);
    void carryByWheels(PlaneEstimate& estimate);
    void learnFromWheels(Step& step);

    // The stages of track(), in their order.
    Extrapolation predictMotion(double duration_s);
    VoxelNumbers thin(ScanView& view, bool byStanding);
    Placement registerByPoints(const ScanView& view, const Expectation& expected,
                               std::optional<DynamicObjects::Sight>& sight, Step& step) const;
    void removeDynamicObjects(const VoxelNumbers& voxels, DynamicObjects::Sight sight,
                              const Eigen::Isometry3d& pose, ScanView& view);
    PlaneEstimate registerByPlanes(const PointCloud& cloud, const PointEstimate& placed,
                                   const Eigen::Isometry3d& predicted, double since_s,
                                   ScanView& view, Step& step);
    void update(const PlaneEstimate& estimate, const PointEstimate& placed,
                const Eigen::Isometry3d& predicted, double since_s, bool hasSight, ScanView& view,
                const Step& step);
    bool isImplausible(const PointEstimate& placed) const;
    bool isBeyondReach(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                       double since_s) const;
    bool hasDrifted(const PlaneEstimate& estimate, double inlierRatio) const;
    void miss(const PointCloud& cloud);
    bool isLostAfter(const Step& step) const;
    void report(const PlaneEstimate& estimate, ScanView& view, Step& step) const;
    void carryToStamp(double stamp_s, bool hasFoundMotion, Step& step);

    Expectation expectation(const Eigen::Isometry3d& predicted, bool isGuess, double since_s,
                            bool timeIsKnown) const;
    void learn(const PointEstimate& placed, const Eigen::Isometry3d& predicted, double since_s);

    // De-skewing by the motion that was found (pipeline_deskew.cpp).
    void deskewAgain(const PointCloud& cloud, double since_s, double inlierRatio, ScanView& view,
                     PlaneEstimate& estimate);
    ScanTrajectory refined(const ScanTrajectory& start, const KnownEnds& known,
                           const PointCloud& cloud, const ScanView& view) const;
    std::optional<ScanOnTrajectory> deskewByMotion(const KnownEnds& known, double inlierRatio,
                                                   const PointCloud& cloud,
                                                   const ScanView& view) const;
    std::optional<ScanOnTrajectory> deskewPair(const PointCloud& first, KnownEnds known,
                                               const PointCloud& cloud, const ScanView& view);
    void deskewFirst(const PointCloud& first, const ScanTrajectory& trajectory);

    // The map.
    ScanView beginMap(const PointCloud& cloud, bool motionIsKnown);
    void beginAnew(const PointCloud& cloud);
    void insertLater(ScanView& view);
    void insertWaiting();
    void takeScale(double scale);
    bool isOtherScale();
    // The map that the sensor left when it was lost (pipeline_rejoin.cpp).
    void leaveMap();
    void rejoin(const ScanView& view);
    void moveToLeftMap(const Eigen::Isometry3d& toLeft);
    void correctPast(Step& step);
    /** The vertical in the map's frame, of a sensor at `pose`. */
    Eigen::Vector3d upAt(const Eigen::Isometry3d& pose) const {
        return pose.linear() * upright_.row(2).transpose().cast<double>();
    }
    /** Motion and place of the next scan are not known well. */
    bool isGuessing() const {
        return isLost(state_) || std::holds_alternative<Degenerate>(state_) ||
               !prediction_.hasMotion();
    }
    /** Until the motion is known, and after a loss, the points that stand above the ground place a
     *  scan. A hand tilts the sensor so much that they are not told from the ground. */
    bool isPlacedByStanding(bool isGuess) const {
        if (!prediction_.hasMotion()) return true;
        if (isLost(state_)) return !isShaken();
        const bool isSteady = kernel_m() < options_.points.first_kernel;
        return isGuess && isSteady && !std::holds_alternative<Degenerate>(state_);
    }
    /** Predictions are off by more than any kernel. */
    bool isShaken() const {
        return kernel().isKnown() && kernel_m() >= options_.points.first_kernel;
    }
    Motion motion() const;
    double kernel_m() const {
        return kernel().width(options_.points.least_kernel, options_.points.first_kernel);
    }
    const AdaptiveKernel& kernel() const { return usesGyro_ ? gyroKernel_ : kernel_; }
    PlaneEstimate predictedEstimate(const Eigen::Isometry3d& pose) const {
        return odometry::predictedEstimate(pose, options_.registration,
                                           errorGrowth(unregistered_s_));
    }

    const PlaneOdometryOptions given_;
    ScaledOptions options_;                                  //!< at the scale of the place
    Eigen::Matrix3f upright_ = Eigen::Matrix3f::Identity();  //!< turns the sensor's z up
    double scale_ = 1;
    double seenScale_ = 1;     //!< that the latest scan shows
    unsigned otherScale_ = 0;  //!< scans in a row that show a place of another size

    TrackingState state_;
    std::size_t track_ = 0, latestTrack_ = 0;  //!< Step::track, and its greatest value
    Arrivals arrivals_;
    double time_s_ = 0;  //!< of the latest scan, since the start
    LocalMap map_;
    DynamicObjects dynamics_;
    OwnVehicle own_;
    ReferenceScan reference_;
    Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();  //!< of the latest scan: sensor to map
    ScanTrajectory motion_{Twist{}};  //!< during the latest scan, seen from pose_
    Stamped stamped_;                 //!< the latest scan at its stamp
    /** Sensor at the latest stamp to that at the first one, as the steps said. */
    Eigen::Isometry3d said_ = Eigen::Isometry3d::Identity();
    double unregistered_s_ = 0;  //!< since the latest scan that was registered
    /** The latest scan as it came, where its points have times, and its trajectory (sensor to map,
     *  times from the scan's). */
    struct Latest {
        PointCloud cloud;
        double time_s = 0;
        ScanTrajectory trajectory{Twist{}};
    };
    std::optional<Latest> latest_;
    ScanTrajectory trajectoryOfLatest() const { return placed(pose_, motion_); }
    /** One of the first scans of the map, and its points in the map, where it was tracked. */
    struct BeginningScan {
        Latest scan;
        std::optional<PlacedPoints> points;
        std::size_t track = 0;  //!< Step::track
    };
    /** The first scans of the map, and those before it whose motion is not known, oldest first,
     * until they are registered again. */
    std::vector<BeginningScan> beginning_;
    /** The latest scans, where the motion changes faster than it can be predicted. */
    ScanWindow window_;
    /** The window holds all scans of the map: each scan more corrects the earlier ones. */
    struct Start {
        double stamp_s = 0;  //!< of the first scan, since the start of the drive
        /** Sensor at the latest stamp to that at the first one, as the steps said. */
        Eigen::Isometry3d reported = Eigen::Isometry3d::Identity();
    };
    std::optional<Start> start_;
    /** The map before the sensor was lost: the new map began at a prediction. */
    struct LeftMap {
        LocalMap map;
        ReferenceScan reference;
        Eigen::Isometry3d toSaid = Eigen::Isometry3d::Identity();  //!< its frame to that of said_
        double usualInlierRatio = 0;
        std::size_t track = 0;  //!< of its scans
        double left_s = 0;      //!< time of the first scan in the new map
        unsigned scans = 0;     //!< that were sought in it since
        /** New map's frame to this map's, as the latest scan has it. */
        std::optional<Eigen::Isometry3d> toThis;
    };
    std::optional<LeftMap> left_;
    /** An earlier scan, whose pose later scans may correct. */
    struct PastScan {
        double time_s = 0;                                       //!< of the scan, since the start
        double stamp_s = 0;                                      //!< its stamp, likewise
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< at the stamp, sensor to map
        Eigen::Isometry3d said = Eigen::Isometry3d::Identity();  //!< the same as the steps said
        bool isCorrected = false;                                //!< by the latest scan
    };
    std::deque<PastScan> past_;  //!< the latest ones, oldest first
    /** The latest scan, until it enters the map: the next scan is thinned meanwhile. */
    std::optional<PlacedPoints> waiting_;

    // The motion model, learnt while tracking.
    LinearPrediction prediction_;
    AdaptiveKernel kernel_;
    Unevenness unevenness_;
    std::optional<Extrapolation> extrapolation_;  //!< where the points have times
    double usualInlierRatio_ = 0;                 //!< 0: not known
    double latestInlierRatio_ = 0;                //!< of the latest scan that was registered

    // The rotation by a gyroscope, and how far predictions by it are off.
    GyroPrior gyro_;
    bool usesGyro_ = false;  //!< for this scan
    AdaptiveKernel gyroKernel_;
    Unevenness gyroUnevenness_;
    Eigen::Isometry3d atConstantSpeed_ = Eigen::Isometry3d::Identity();  //!< predicted without it

    // The translation by wheels.
    WheelPrior wheels_;
    std::optional<WheelStep> wheelStep_;  //!< since the latest scan
    bool isCarried_ = false;              //!< this scan, along an axis that it does not show
    bool wasObserved_ = false;            //!< the latest scan, along every axis
};
}  // namespace delio::odometry
