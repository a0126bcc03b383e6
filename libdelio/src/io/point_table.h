#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "delio/scan/scan.h"

namespace delio::io {
/** Kinds of numbers, numbered as sensor_msgs/PointField has them. */
enum class NumberKind : std::uint8_t {
    kInt8 = 1,
    kUint8,
    kInt16,
    kUint16,
    kInt32,
    kUint32,
    kFloat32,
    kFloat64
};
/** 0: there is no such kind. */
std::size_t bytesOf(NumberKind kind);

/** One number of a point's record. */
struct PointField {
    std::string name;
    std::size_t offset = 0;  //!< in the record, bytes
    NumberKind kind = NumberKind::kFloat32;
};

/** Points as records of named numbers, as ROS, PCD and PLY have them. */
struct PointLayout {
    std::vector<PointField> fields;
    std::size_t step = 0;  //!< from one record to the next, bytes
    bool bigEndian = false;
};

/** Makes scans of such points: x y z; intensity (or `i`, `reflectivity`, `signal`); ring (or
 *  `channel`, `line`, `laser_id`); time (or `t`, `timestamp`, `time_stamp`, `offset_time`,
 *  `point_time_offset`, ...). The unit of times (s, ms, us or ns), and whether they count from the
 *  stamp, from the first point or are Unix time, is told from the first scan that turns, and kept.
 *  All zero: there are none. One decoder a drive. */
class PointTable {
 public:
    /** Points, rings and times of a scan stamped `stamp_s` (Unix seconds, or as the source counts).
     *  `bytes` are all that is at `data`; they have to hold `count` records. Rings of an organised
     *  cloud (`rows` of `count / rows` points, row by row) without a ring field are its rows.
     *  Throws Error for fields that are missing, of a kind that is not known, or do not lie within
     *  the record, and where bytes are missing. */
    Scan scan(const PointLayout& layout, const std::uint8_t* data, std::size_t bytes,
              std::size_t count, std::size_t rows, double stamp_s);

 private:
    struct Clock {
        double unit_s = 1;
        enum class Zero { kStamp, kFirstPoint, kUnix } zero = Zero::kStamp;
    };
    void setTimes(const std::vector<double>& raw, double stamp_s, Scan& scan);

    std::optional<Clock> clock_;
};
}  // namespace delio::io
