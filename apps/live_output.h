#pragma once
#include <memory>
#include <string>

#include "delio/run/run.h"
#include "live_map.h"
#include "live_view.h"
#include "map_server.h"
#include "slam_command_line.h"

namespace delio {
/** Where a drive is shown while it is processed: a window (--gui), a page (--serve). Results are
 * the same with and without. */
class LiveOutput {
 public:
    /** Throws Error where one of them cannot be shown. */
    explicit LiveOutput(SlamCommandLine& line);

    /** Before the first scan of a drive. */
    void begin(run::Run& run);
    /** After the last one. */
    void end();
    /** Returns when the window is closed, or the program is interrupted. */
    void waitForWindow() const;

 private:
    std::shared_ptr<LiveMap> map_;  //!< null where nothing is shown
    std::unique_ptr<MapServer> server_;
    std::unique_ptr<LiveView> view_;
};
}  // namespace delio
