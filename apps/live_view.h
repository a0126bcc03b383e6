#pragma once
#include <memory>

#include "delio/core/odometry_options.h"
#include "delio/slam/slam.h"

namespace delio {
/** A window that shows a drive while it is processed: the map as it grows, the current scan and the
 *  trajectory; the normals' pattern on the sphere; the lines of the last two scans and their pairs.
 *  Nothing depends on it: results are the same with and without. */
class LiveView : public SlamListener {
 public:
    /** Throws Error where there is no display, or where this program was built without mrpt-gui. */
    explicit LiveView(const PaperOdometryOptions& options);
    ~LiveView() override;
    LiveView(const LiveView&) = delete;
    LiveView& operator=(const LiveView&) = delete;

    const char* name() const override { return "live_view"; }
    /** Does nothing once the window was closed. */
    void add(const SlamScan& scan) override;

    bool isOpen() const;

 private:
    struct Window;
    std::unique_ptr<Window> window_;
};
}  // namespace delio
