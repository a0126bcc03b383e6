#pragma once
#include <mrpt/hwdrivers/CGenericSensor.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <utility>

#include "recordings/decode_observation.h"

namespace delio {
/** What drivers gave, until it is written. Where more than 20 scans wait, the oldest is dropped.
 */
class WaitingObjects {
 public:
    using Object = mrpt::serialization::CSerializable::Ptr;

    void add(const mrpt::hwdrivers::CGenericSensor::TListObservations& objects) {
        if (objects.empty()) return;
        const std::lock_guard lock(mutex_);
        for (const auto& [time, object] : objects) {
            waiting_.push_back(object);
            scans_ += isScan(object);
            if (scans_ > kMostScans) dropOldest();
        }
        changed_.notify_one();
    }

    /** Waits for some, a moment at most. */
    std::deque<Object> take() {
        constexpr auto kWait = std::chrono::milliseconds(100);
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kWait, [&] { return !waiting_.empty(); });
        scans_ = 0;
        return std::exchange(waiting_, {});
    }

    /** Scans so far. */
    std::size_t dropped() const {
        const std::lock_guard lock(mutex_);
        return dropped_;
    }

 private:
    static constexpr std::size_t kMostScans = 20;

    static bool isScan(const Object& object) {
        const auto* scan = dynamic_cast<const mrpt::obs::CObservation*>(object.get());
        return scan && io::isScan(*scan);
    }

    void dropOldest() {
        waiting_.erase(std::find_if(waiting_.begin(), waiting_.end(), isScan));
        --scans_;
        ++dropped_;
    }

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Object> waiting_;
    std::size_t scans_ = 0;  //!< that wait
    std::size_t dropped_ = 0;
};
}  // namespace delio
