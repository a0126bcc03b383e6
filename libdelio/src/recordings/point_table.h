#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "delio/odometry/scan.h"
#include "formats/point_records.h"
#include "point_clock.h"

namespace delio::io {
/** Which scan of a drive. */
struct ScanPlace {
    double stamp_s = 0;     //!< Unix seconds, or as the source counts
    std::size_t index = 0;  //!< among the scans of the drive
};

/** True for the points of Livox's drivers, which have a `tag` and a `line`. Their lines are no
 *  rings: a beam has no elevation of its own. */
bool isLivox(const PointLayout& layout);

/** True where its points have times. */
bool hasTimes(const PointLayout& layout);

/** Makes scans of such points: x y z; intensity (or `i`, `reflectivity`, `signal`); ring (or
 *  `channel`, `line`, `laser_id`); time (or `t`, `timestamp`, `time_stamp`, `offset_time`,
 *  `point_time_offset`, ...), whose unit and zero PointClock finds. One a drive. */
class PointTable {
 public:
    /** Points, rings and times of a scan. `bytes` are all that is at `data`; they have to hold
     *  `count` records. Rings of an organised cloud (`rows` of `count / rows` points, row by row)
     *  without a ring field are its rows, or its columns where there are fewer of them.
     *  Throws Error for fields that are missing, of a kind that is not known, or do not lie within
     *  the record, and where bytes are missing. */
    Scan scan(const PointLayout& layout, const std::uint8_t* data, std::size_t bytes,
              std::size_t count, std::size_t rows, const ScanPlace& place);

    /** Looks at the point times of one of the first scans, which scan() is to be called for later.
     *  False: enough were seen. Throws as scan(). */
    bool look(const PointLayout& layout, const std::uint8_t* data, std::size_t bytes,
              std::size_t count, double stamp_s);

    /** See PointClock. */
    std::vector<std::string> findings() const { return clock_.findings(); }

 private:
    PointClock clock_;
};
}  // namespace delio::io
