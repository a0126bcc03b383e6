#pragma once
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/wheels.h"

namespace delio::io {
/** A bounded queue of scans, IMU and odometry samples, from the threads of sensors' drivers to the
 * one that processes them. Where too many scans wait, whole ones are dropped, such that those that
 * remain are as even in time as possible: an odometry bridges several short gaps better than a long
 * one. Samples are kept. Every function may be called by any thread. */
class ScanFeed {
 public:
    /** A scan, and the samples that were added before it and after the scan before. */
    struct Item {
        Scan scan;                             //!< as it was added, but Scan::dropped
        std::vector<ImuSample> imu;            //!< in the order in which they were added
        std::vector<OdometrySample> odometry;  //!< likewise
        std::optional<double> received_s;      //!< Unix time at which the sensor's last packet came
    };

    /** `mostWaiting`: scans that may wait; at least 1. `onFirstDrop`: called when the first one is
     *  dropped, by the thread that adds. */
    explicit ScanFeed(std::size_t mostWaiting = 10, std::function<void()> onFirstDrop = {});

    /** Adds the next scan. `received_s`: see Item. */
    void add(Scan scan, std::optional<double> received_s = {});
    /** Adds a sample of the IMU, stamped as the scans. */
    void add(const ImuSample& sample);
    /** Adds a pose by the wheels, likewise. */
    void add(const OdometrySample& sample);
    /** There are no more. What waits can still be taken. */
    void close();
    /** The same; take() throws `fault` after the last scan. */
    void close(std::exception_ptr fault);

    /** Waits for the next scan; nothing at the end. Once too many have waited, a quarter of those
     *  that wait is dropped first, to catch up with the sensor, until fewer than four wait. */
    std::optional<Item> take();

    /** Scans that were dropped so far. */
    std::size_t dropped() const;

 private:
    std::size_t leastMissed() const;
    void drop(std::size_t item);
    void catchUp();

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t mostWaiting_;
    std::function<void()> onFirstDrop_;
    std::deque<Item> waiting_;
    std::vector<ImuSample> imu_;            //!< since the latest scan
    std::vector<OdometrySample> odometry_;  //!< likewise
    bool closed_ = false;
    std::exception_ptr fault_;
    std::optional<double> taken_s_;  //!< stamp of the scan that was taken last
    bool isLate_ = false;            //!< too many have waited
    std::size_t dropped_ = 0;
};
}  // namespace delio::io
