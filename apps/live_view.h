#pragma once
#include <memory>

#include "delio/odometry.h"
#include "delio/scan/scan.h"

namespace delio {
/** A window that shows a drive while it is processed: the map as it grows, the current scan and the
 *  trajectory; the normals' pattern on the sphere; the lines of the last two scans and their pairs.
 *  Nothing depends on it: results are the same with and without. */
class LiveView {
 public:
    /** Throws Error where there is no display, or where this program was built without mrpt-gui. */
    explicit LiveView(const OdometryOptions& options);
    ~LiveView();
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    /** Does nothing once the window was closed.
     *  @param increment of the sensor, from the scan before to this one
     *  @param pose of the vehicle at this scan */
    void show(const Scan& scan, const mrpt::poses::CPose3D& increment,
              const mrpt::poses::CPose3D& pose);

    bool isOpen() const;

 private:
    struct Window;
    std::unique_ptr<Window> window_;
};
}  // namespace delio
