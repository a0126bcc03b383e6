#pragma once
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/wheels.h"
#include "delio/recordings/scan_feed.h"
#include "delio/slam/slam.h"

namespace delio {
/** A Slam in a thread of its own, fed by the threads of sensors' drivers. add() does not wait:
 *  where too many scans wait, whole ones are dropped, evenly in time. Poses come to the listeners
 * of the Slam, in its thread. That thread and TBB's threads that work for it stay on different
 * processors. */
class LiveSlam {
 public:
    /** Scans so far. */
    struct Report {
        std::size_t processed = 0;  //!< that the listeners got
        std::size_t dropped = 0;    //!< for lack of time
        std::size_t refused = 0;    //!< that the odometry does not understand
        std::string refusal;        //!< why the first of these; empty: none
    };

    /** `slam`: with its listeners. `mostWaiting`: scans that may wait. */
    explicit LiveSlam(std::unique_ptr<Slam> slam, std::size_t mostWaiting = 10);
    /** As finish(). */
    ~LiveSlam();
    LiveSlam(const LiveSlam&) = delete;
    LiveSlam& operator=(const LiveSlam&) = delete;

    /** Takes the next scan of the LiDAR. By any thread, in the order of the stamps. */
    void add(Scan scan) { feed_.add(std::move(scan)); }
    /** Takes a sample of the IMU, stamped as the scans. By any thread. */
    void add(const ImuSample& sample) { feed_.add(sample); }
    /** Adds a pose by the drive's wheels: see Odometry::addOdometry(). */
    void add(const OdometrySample& sample) { feed_.add(sample); }

    /** Waits until the scans that wait are processed. No scan is taken from here on. */
    void finish();

    /** By any thread. */
    Report report() const;

    /** After finish(). */
    const Slam& slam() const { return *slam_; }

 private:
    void run();

    std::unique_ptr<Slam> slam_;
    io::ScanFeed feed_;
    mutable std::mutex mutex_;
    Report report_;
    std::thread thread_;
};
}  // namespace delio
