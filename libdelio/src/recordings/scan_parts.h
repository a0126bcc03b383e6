#pragma once
#include <deque>
#include <optional>

#include "delio/odometry/scan.h"

namespace delio::io {
/** Adds the points of a later part of a scan. Its rings and times are kept where both have them. */
void append(Scan& scan, const Scan& part);

/** Puts the messages of a LiDAR that does not turn together, until they last 0.1 s: a shorter
 *  pattern is too sparse to be registered. A message that lasts longer is a scan of its own. A
 *  message that starts earlier than the one before starts a new scan. */
class PatternJoiner {
 public:
    /** A message; its times count from its stamp. */
    void add(Scan part);
    /** There are no more messages. */
    void finish();
    std::optional<Scan> take();
    /** Stamp of the scan that the next part may belong to; nothing before its first part. */
    std::optional<double> begun_s() const;
    /** Scans that were made of several messages. */
    std::size_t joined() const { return joined_; }

 private:
    void close();

    std::optional<Scan> begun_;
    double latest_s_ = 0;  //!< stamp of its latest part
    std::size_t parts_ = 0, joined_ = 0;
    std::deque<Scan> ready_;
};
}  // namespace delio::io
