#pragma once
#include <optional>

#include "delio/core/odometry_options.h"
#include "delio/odometry/odometry.h"
#include "odometry/arrivals.h"
#include "odometry/dynamic_objects.h"
#include "odometry/inertial.h"
#include "odometry/initial_guess.h"
#include "odometry/motion_model.h"
#include "odometry/moving_scan.h"
#include "odometry/own_vehicle.h"
#include "odometry/place_scale.h"
#include "odometry/register_together.h"
#include "odometry/register_trajectory.h"
#include "odometry/reported_path.h"
#include "odometry/search_speed.h"
#include "odometry/tracking_state.h"
#include "odometry/wheels.h"

namespace delio::odometry {
/** Points that wait to enter the map. */
struct PlacedPoints {
    Eigen::Matrix3Xf points;                                 //!< sensor's frame
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
};

/** How far the predictions of the pose were off lately. */
struct PredictionErrors {
    AdaptiveKernel kernel;
    Unevenness unevenness;
};

/** Inlier ratios of scans that were registered to points; 0: not known. */
struct InlierRatios {
    double usual = 0;
    double latest = 0;
    double planes = 0;  //!< of the latest scan on planes that constrained it
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
    void settle() override;
    void addImu(const ImuSample& sample) override { gyro_.add(sample); }
    std::optional<ImuReport> imuReport() const override { return gyro_.report(); }
    void addOdometry(const OdometrySample& sample) override { wheels_.add(sample); }
    std::optional<OdometryReport> odometryReport() const override { return wheels_.report(); }
    Eigen::AlignedBox3d ownVehicle() const override { return own_.box(); }

 private:
    // The stages of process(), in their order.
    PointCloud prepare(const Scan& scan, Step& step);
    Interval arrive(const Scan& scan, const PointCloud& cloud, Step& step);
    void begin(const PointCloud& cloud, const Interval& interval, Step& step);
    void skip(const PointCloud& cloud, const Interval& interval, Step& step);
    void interrupt(double elapsed_s);

    /** A scan placed by points, from one guess of the motion. */
    struct Attempt {
        Eigen::Isometry3d predicted = Eigen::Isometry3d::Identity();  //!< sensor to map
        /** Where the motion of the scans before leads to. */
        Eigen::Isometry3d extrapolated = Eigen::Isometry3d::Identity();
        ScanTrajectory motion{Twist{}};  //!< that it was de-skewed by
        ScanView view;
        std::optional<DynamicObjects::Sight> sight;
        Placement placement;

        bool isBetterThan(const Attempt& other) const {
            const auto &mine = placement.estimate, &others = other.placement.estimate;
            return mine.valid && (!others.valid || mine.inlierRatio > others.inlierRatio);
        }
    };
    void track(const PointCloud& cloud, Attempt attempt, Step& step);
    void correctStampBefore(const PointCloud& cloud, const Step& step);
    void extendPath(double stamp_s, bool hasFoundMotion, Step& step);
    void finish(PointCloud cloud, Step& step);

    // Where a scan may be: from which motions it is placed by points (pipeline_attempts.cpp).
    Attempt attemptToTrack(const PointCloud& cloud, const Interval& interval, Step& step);
    Attempt attemptWithGyro(const PointCloud& cloud, double duration_s, double since_s,
                            bool timeIsKnown, Step& step);
    std::optional<Attempt> attemptByGyro(const PointCloud& cloud, double duration_s, double since_s,
                                         Step& step);
    Attempt attemptAsPredicted(const PointCloud& cloud, double duration_s, double since_s,
                               bool timeIsKnown, Step& step);
    Attempt attemptAfterPause(const PointCloud& cloud, const Interval& interval, double since_s,
                              Step& step);
    Attempt attemptByWheels(const PointCloud& cloud, double duration_s, Attempt alone, Step& step);
    Attempt attemptBy(const PointCloud& cloud, const Expectation& expected,
                      const ScanTrajectory& motion, Step& step);
    bool isImplausible(const PointEstimate& placed) const;
    Motion motion() const;
    Extrapolation predictMotion(double duration_s);
    Expectation expectation(const Eigen::Isometry3d& predicted, bool isGuess, double since_s,
                            bool timeIsKnown) const;
    std::optional<RangeImage> thin(ScanView& view, bool byStanding);
    std::optional<DynamicObjects::Sight> registerByPoints(const ScanView& view,
                                                          const Expectation& expected,
                                                          std::optional<RangeImage> freeSpace,
                                                          Placement& placement, Step& step) const;

    // Scans that are registered together (pipeline_window.cpp).
    bool extendWindow(const PointCloud& cloud, double since_s, const Placement& found, Step& step);
    Attempt attemptInWindow(const PointCloud& cloud, double since_s, Step& step);
    Attempt attemptAgain(const PointCloud& cloud, double since_s, Attempt first, Step& step);
    void prepare(FirstScan& first) const;
    void beginMapAgain();
    void settleWindow(const Step& step);
    void endWindow();
    void keep(PointCloud cloud, const Step& step);
    void findOwn();
    bool isSecondScan() const {
        const auto* first = std::get_if<FirstScan>(&state_);
        return first && first->skewed;
    }

    // The first scans of a map, once more (pipeline_retrace.cpp).
    void retraceStart(const PointCloud& cloud, const Step& step);
    bool extendBeginning(const PointCloud& cloud, const Step& step);
    std::optional<double> latestOnPlanes() const;
    void retrace();
    void registerStartAgain(std::size_t count);
    void turnBack(const PlaneOdometry& ahead, std::size_t first);
    std::optional<ScanTrajectory> stepBack(const MovingScan& scan);

    // The speed where single scans do not show it (pipeline_speed.cpp).
    void countMisfits(const PlaneEstimate& estimate, double inlierRatio, double since_s);
    Eigen::Matrix3Xd axesOfVehicles(const PlaneEstimate& estimate) const;
    bool settleSpeed(const PointCloud& cloud, const PlaneEstimate& estimate);
    void restartAt(const std::vector<MovingScan>& scans);

    // The stages of track(), in their order.
    void removeDynamicObjects(DynamicObjects::Sight sight, const Eigen::Isometry3d& pose,
                              ScanView& view);
    PlaneEstimate registerByPlanes(const PointCloud& cloud, const PointEstimate& placed,
                                   const Eigen::Isometry3d& predicted, double since_s,
                                   ScanView& view, Step& step);
    void update(const PlaneEstimate& estimate, const PointEstimate& placed,
                const Eigen::Isometry3d& predicted, double since_s, bool hasSight, ScanView& view,
                const Step& step);
    bool isBeyondReach(const PointEstimate& placed, const Eigen::Isometry3d& predicted,
                       double since_s) const;
    bool hasDrifted(const PlaneEstimate& estimate, double inlierRatio) const;
    void miss(const PointCloud& cloud);
    bool isLostAfter(const Step& step) const;
    void report(const PlaneEstimate& estimate, ScanView& view, Step& step) const;
    void learn(const PointEstimate& placed, const Eigen::Isometry3d& predicted, double since_s);
    void learnFromGyro(const Eigen::Isometry3d& predicted, double since_s);
    bool isObserved(const Step& step) const;

    // De-skewing by the motion that was found (pipeline_deskew.cpp).
    std::optional<ScanOnTrajectory> deskewAgain(const PointCloud& cloud, double since_s,
                                                const PointEstimate& placed,
                                                const Eigen::Isometry3d& predicted,
                                                const Eigen::Isometry3d& pose,
                                                const ScanView& view);
    std::optional<ScanTrajectory> trajectoryByGyro(const KnownEnds& known,
                                                   const PointCloud& cloud) const;
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
    // The map that the sensor left when it was lost (pipeline_rejoin.cpp).
    void leaveMap();
    void rejoin(const ScanView& view);
    void moveToLeftMap(const Eigen::Isometry3d& toLeft);
    /** The vertical in the map's frame, of a sensor at `pose`. */
    Eigen::Vector3d upAt(const Eigen::Isometry3d& pose) const {
        return pose.linear() * upright_.row(2).transpose().cast<double>();
    }
    /** Motion and place of the next scan are not known well. */
    bool isGuessing() const {
        return isLost(state_) || std::holds_alternative<Degenerate>(state_) ||
               !prediction_.hasMotion();
    }
    /** Until the motion is known, after a loss, and where planes do not constrain every axis, the
     *  points that stand above the ground place a scan. A hand that swings tilts the sensor too
     *  much to tell them from the ground. */
    bool isPlacedByStanding(bool isGuess) const {
        if (!prediction_.hasMotion()) return true;
        if (isLost(state_)) return !isShaken();
        return (isGuess || planeMatches_ == 0) && !isShaken();
    }
    /** Predictions are off by more than any kernel. */
    bool isShaken() const {
        return errors().kernel.isKnown() && kernel_m() >= options().points.first_kernel;
    }
    /** The map's first scans, whose motion is not known as well, have been registered again. */
    bool isSettled() const { return beginning_.empty() && speeds_; }
    /** The latest scan was tracked, and many planes constrained it. */
    bool haveManyPlanes() const {
        return std::holds_alternative<Tracking>(state_) && planeMatches_ >= kManyPlanes &&
               !isShaken();
    }
    double kernel_m() const {
        return errors().kernel.width(options().points.least_kernel, options().points.first_kernel);
    }
    const PredictionErrors& errors() const { return usesGyro_ ? gyroErrors_ : errors_; }
    const ScaledOptions& options() const { return place_.options(); }
    PlaneEstimate predictedEstimate(const Eigen::Isometry3d& pose) const {
        return odometry::predictedEstimate(pose, options().registration,
                                           errorGrowth(unregistered_s_));
    }

    PlaceScale place_;
    /** Of the latest scan; 0: the planes did not constrain it along every axis. */
    std::size_t planeMatches_ = 0;
    static constexpr std::size_t kManyPlanes = 1000;
    Eigen::Matrix3f upright_ = Eigen::Matrix3f::Identity();  //!< turns the sensor's z up

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
    ReportedPath path_;
    bool isUrgent_ = false;             //!< scans were dropped before this one for lack of time
    double unregistered_s_ = 0;         //!< since the latest scan that was registered
    std::optional<MovingScan> latest_;  //!< where its points have times
    bool mayShowOwn_ = false;           //!< the own vehicle was not sought in the latest scan yet
    ScanTrajectory trajectoryOfLatest() const { return placed(pose_, motion_); }
    /** One of the first scans of the map, and its points in the map, where it was tracked. */
    struct BeginningScan {
        MovingScan scan;
        std::optional<PlacedPoints> points;
        std::size_t track = 0;  //!< Step::track
        /** InlierRatios::planes; nothing for the first scan of a map. */
        std::optional<double> onPlanes = {};
    };
    /** The first scans of the map, and those before it whose motion is not known, oldest first,
     * until they are registered again. */
    std::vector<BeginningScan> beginning_;
    bool mayRetrace_ = false;  //!< retrace() registers the first of them again
    /** The latest scans, where the motion changes faster than it can be predicted. */
    ScanWindow window_;
    /** While single scans do not show the speed. None while scans are retraced. */
    std::optional<SpeedSearch> speeds_;
    unsigned shownSpeeds_ = 0;  //!< scans in a row up to the latest one that show the speed
    unsigned misfits_ = 0;      //!< see countMisfits()
    /** The window holds all scans of the map: each scan more corrects the earlier ones. */
    struct Start {
        double stamp_s = 0;  //!< of the first scan, since the start of the drive
        Eigen::Isometry3d reported = Eigen::Isometry3d::Identity();  //!< of that scan (Anchor)
    };
    std::optional<Start> start_;
    /** The map before the sensor was lost: the new map began at a prediction. */
    struct LeftMap {
        LocalMap map;
        ReferenceScan reference;
        Anchor anchor;
        double usualInlierRatio = 0;
        double scale = 1;       //!< PlaceScale::scale()
        std::size_t track = 0;  //!< of its scans
        double left_s = 0;      //!< time of the first scan in the new map
        unsigned scans = 0;     //!< that were sought in it since
        /** New map's frame to this map's, as the latest scan has it. */
        std::optional<Eigen::Isometry3d> toThis;
    };
    std::optional<LeftMap> left_;
    /** The latest scan, until it enters the map: the next scan is thinned meanwhile. */
    std::optional<PlacedPoints> waiting_;

    // The motion model, learnt while tracking.
    LinearPrediction prediction_;
    std::optional<Extrapolation> extrapolation_;  //!< where the points have times
    PredictionErrors errors_;
    InlierRatios inlierRatios_;

    GyroPrior gyro_;
    bool usesGyro_ = false;        //!< it predicts the rotation of this scan
    PredictionErrors gyroErrors_;  //!< of these predictions
    Eigen::Isometry3d atConstantSpeed_ = Eigen::Isometry3d::Identity();  //!< predicted without it
    Wheels wheels_;
};
}  // namespace delio::odometry
