#pragma once
#include <memory>

#include "live_map.h"

namespace delio {
/** A window that shows a map that grows: its points by their height above the ground, the current
 *  scan and the trajectory. A thread of its own draws, a small part of the time. */
class LiveView {
 public:
    /** Throws Error where there is no display, or where this program was built without mrpt-gui. */
    explicit LiveView(std::shared_ptr<const LiveMap> map);
    ~LiveView();
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    bool isOpen() const;

 private:
    struct Window;
    std::unique_ptr<Window> window_;
};
}  // namespace delio
