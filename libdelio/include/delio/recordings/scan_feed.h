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
 * one that processes them. Where scans wait that are too many, the oldest one is dropped as a
 * whole; their samples are kept. Every function may be called by any thread. */
class ScanFeed {
 public:
    /** A scan, and the samples that were added before it and after the scan before. */
    struct Item {
        Scan scan;                             //!< as it was added
        std::vector<ImuSample> imu;            //!< in the order in which they were added
        std::vector<OdometrySample> odometry;  //!< likewise
        std::optional<double> received_s;      //!< Unix time at which the sensor's last packet came
    };

    /** `mostWaiting`: scans that may wait; at least 1. `onFirstDrop`: called when the first one is
     *  dropped, by the thread that adds. */
    explicit ScanFeed(std::size_t mostWaiting = 5, std::function<void()> onFirstDrop = {});

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

    /** Waits for the next scan; nothing at the end. */
    std::optional<Item> take();

    /** Scans that were dropped so far. */
    std::size_t dropped() const;

 private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t mostWaiting_;
    std::function<void()> onFirstDrop_;
    std::deque<Item> waiting_;
    std::vector<ImuSample> imu_;            //!< since the latest scan
    std::vector<OdometrySample> odometry_;  //!< likewise
    bool closed_ = false;
    std::exception_ptr fault_;
    std::size_t dropped_ = 0;
};
}  // namespace delio::io
