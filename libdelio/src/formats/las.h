#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "point_records.h"

namespace delio::io {
/** A named number that points have in addition to those of LAS. */
struct LasExtra {
    std::string name;
    NumberKind kind = NumberKind::kFloat32;
    std::string description;  //!< at most 31 characters are kept
};

/** A point as LAS has it. */
struct LasPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  //!< metres, in the file's coordinates
    std::uint16_t intensity = 0;
    std::uint8_t classification = 1;  //!< 1: unclassified, 2: ground
    double time_s = 0;                //!< see LasFile::gpsTime
    std::vector<double> extras;       //!< in the order of LasFile::extras
};

/** Everything in a LAS file but its points. */
struct LasFile {
    std::string wkt;  //!< coordinate system, as OGC WKT; empty: none
    /** Times are adjusted standard GPS time (GPS seconds less 1e9); false: they start anywhere. */
    bool gpsTime = false;
    std::vector<LasExtra> extras;
};

/** Adjusted standard GPS time of a Unix time, seconds. */
double gpsTimeOf(double unix_s);

/** Writes LAS 1.4, point format 6 (30 bytes and the extras). `pointAt(i, point)` fills the i-th of
 *  `count` points, and is called twice for each. Coordinates are stored in steps of 0.1 mm, or of
 *  1 mm where a side is longer than 200 km. The same points give the same bytes. Throws Error if
 *  the file cannot be written or the points do not fit into it. */
void saveLas(const LasFile& file, std::size_t count,
             const std::function<void(std::size_t i, LasPoint& point)>& pointAt,
             const std::string& path);

/** Header of a LAS file of version 1.0 to 1.4. */
struct LasHeader {
    unsigned minor = 0;   //!< version 1.minor
    unsigned format = 0;  //!< of the points, 0 to 10
    std::size_t recordBytes = 0, count = 0;
    Eigen::Vector3d scale = Eigen::Vector3d::Ones(), offset = Eigen::Vector3d::Zero();
    std::string wkt;                    //!< empty: none
    bool gpsTime = false;               //!< see LasFile
    std::optional<std::size_t> timeAt;  //!< where a record has the time, bytes
    std::vector<PointField> extras;     //!< with plain names; offsets in the record
};

/** Reads the points of a LAS file in blocks. */
class LasReader {
 public:
    /** Throws Error, which names the file, for one that is missing, no LAS, compressed (LAZ), cut
     *  off, or contradicts itself. */
    explicit LasReader(const std::string& path);

    const LasHeader& header() const { return header_; }

    /** Calls `take` with the bytes of each record. Throws Error where the file is cut off. */
    void forEach(const std::function<void(const std::uint8_t* record)>& take);

    /** Position in a record, metres, in the file's coordinates. */
    Eigen::Vector3d position(const std::uint8_t* record) const;

 private:
    void readHeader(const std::vector<char>& bytes, std::size_t size);
    void readVariableRecords(std::size_t headerBytes, std::size_t pointsAt, std::size_t records);
    void takeExtras(const std::vector<char>& bytes);

    RecordFile file_;
    LasHeader header_;
};

/** The number of that kind at `from`. */
double numberAt(const std::uint8_t* from, NumberKind kind);

/** The points of a .las file, as those of a scan: x y z intensity, and where they are there time
 *  and extras. Throws as LasReader. */
CloudRecords readLasScan(const std::string& path);
}  // namespace delio::io
