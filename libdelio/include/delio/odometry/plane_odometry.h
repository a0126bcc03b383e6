#pragma once
#include <optional>

#include "delio/odometry/adaptive_kernel.h"
#include "delio/odometry/arrivals.h"
#include "delio/odometry/odometry.h"
#include "delio/odometry/placement.h"
#include "delio/odometry/scan_course.h"
#include "delio/scan/voxel_grid.h"

namespace delio {
/** Points that wait to come into the map. */
struct PlacedPoints {
    Eigen::Matrix3Xf points;                                 //!< sensor's frame
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to map
};

/** Scan against map, rotation and translation decoupled: first against the points of the scans
 *  before, from the prediction on, then against their planes (ScanToMap). Dynamic objects, found at
 *  the pose by points, are left out of the planes and of the map. Where three scans in a row that
 * are not empty cannot be registered (the recording was interrupted), a new map is begun at the
 *  prediction. Scans whose points have times are undistorted twice: by the predicted motion, and by
 *  the one that was found, uneven as it is. */
class PlaneOdometry : public Odometry {
 public:
    /** Before the first scan. */
    explicit PlaneOdometry(const PlaneOdometryOptions& options);

    Step process(const Scan& scan) override;

 private:
    void takeScale(double scale);
    bool isOtherScale();
    void processFirstOfMap(const scan::PointCloud& cloud, Step& step);
    void processNext(const scan::PointCloud& cloud, const Interval& interval, Step& step);
    void skip(const scan::PointCloud& cloud, const Interval& interval, Step& step);
    Onward onwardMotion(double duration_s);
    scan::VoxelNumbers thinAll(ScanView& view);
    void leaveOutDynamicObjects(const scan::VoxelNumbers& voxels,
                                movers::DynamicObjects::Sight sight, const Eigen::Isometry3d& pose,
                                ScanView& view);
    Expectation expectation(const Eigen::Isometry3d& predicted, double since_s,
                            bool believed) const;
    void undistortAgain(const scan::PointCloud& cloud, double since_s, double inlierRatio,
                        ScanView& view, planes::PlaneEstimate& estimate);
    Course courseOf(const KnownMotion& known, const scan::PointCloud& cloud,
                    const ScanView& view) const;
    std::optional<ScanOnCourse> undistortPair(KnownMotion known, const scan::PointCloud& cloud,
                                              const ScanView& view);
    void undistortFirst(const Course& course);
    void learn(const points::PointEstimate& placed, const Eigen::Isometry3d& predicted,
               double since_s);
    /** In the map's frame, of a sensor at `pose`. */
    Eigen::Vector3d upAt(const Eigen::Isometry3d& pose) const {
        return pose.linear() * upright_.row(2).transpose().cast<double>();
    }
    void insert(const ScanView& view, const Eigen::Isometry3d& pose);
    void insertLater(ScanView& view);
    void settle();
    ScanView beginMap(const scan::PointCloud& cloud);
    void giveUp(const scan::PointCloud& cloud);
    void report(const planes::PlaneEstimate& estimate, const Eigen::Isometry3d& before,
                ScanView& view, Step& step) const;

    const PlaneOdometryOptions given_;
    PlaneOdometryOptions options_;                           //!< at the scale of the place
    Eigen::Matrix3f upright_ = Eigen::Matrix3f::Identity();  //!< turns the sensor's z up
    double scale_ = 1;
    double seenScale_ = 1;     //!< that the latest scan shows
    unsigned otherScale_ = 0;  //!< scans in a row that show a place of another size
    Arrivals arrivals_;
    LinearPrediction prediction_;
    ScanToMap map_;
    movers::DynamicObjects dynamics_;
    AdaptiveKernel kernel_;
    Unevenness unevenness_;
    std::optional<Onward> onward_;  //!< where the points have times
    ReferenceScan reference_;
    Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();  //!< of the latest scan: sensor to map
    double unregistered_s_ = 0;  //!< since the latest scan that was registered
    bool first_ = true;          //!< no scan was seen yet
    bool started_ = false;       //!< the map can be used
    bool lost_ = true;           //!< where the next scan will be is not known to better than metres
    bool doubted_ = false;       //!< the latest scan was observed weakly
    double usualShare_ = 0;      //!< of points on those of the map
    unsigned misses_ = 0;        //!< scans in a row that were not found in the map
    /** The scan that the map began with, while the motion during it is not known. */
    std::optional<scan::PointCloud> skewed_;
    /** The latest scan, where it is not in the map yet: the next one is thinned meanwhile. */
    std::optional<PlacedPoints> awaited_;
};
}  // namespace delio
