#pragma once
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "delio/io/drive_meta.h"
#include "delio/scan/scan.h"

namespace delio::io {
/** Gives the scans of one LiDAR of a drive, one at a time and in order, whatever they are stored
 *  in. Memory does not grow with the length of the drive. */
class ScanReader {
 public:
    ScanReader() = default;
    virtual ~ScanReader() = default;
    ScanReader(const ScanReader&) = delete;
    ScanReader& operator=(const ScanReader&) = delete;

    /** The next scan, or nothing at the end. Scans are counted from 0, those that were skipped
     *  included; `stamp_s` counts from second 0 of the drive, which meta() names (Unix time where
     *  it does not). Throws Error, which names the file, where it is cut off or damaged or a scan
     *  cannot be decoded; after that the reader is at its end. */
    virtual std::optional<Scan> next() = 0;

    /** Passes over the next scan without reading its points; false at the end. Throws as next(). */
    virtual bool skip() = 0;

    /** Name of the sensor that is read; empty until its first scan was met. */
    virtual const std::string& label() const = 0;
    /** Other LiDARs met so far; a caller may want to say that they were not used. */
    virtual const std::set<std::string>& otherLabels() const = 0;

    /** Part of the drive read so far, 0 to 1; nothing where that is not known. */
    virtual std::optional<double> fraction() const = 0;

    /** What is known of the drive; nothing where the source does not say. */
    virtual const std::optional<DriveMeta>& meta() const = 0;
};

/** The scans at `path`: a rawlog (see RawlogReader). `label`: the sensor to read; empty: that of
 *  the first scan. `imagesFolder`: where the files lie that a rawlog keeps outside of itself;
 *  empty: beside it. Throws Error if there is nothing to read, or if what is said about the drive
 *  (its meta.yaml) cannot be understood. */
std::unique_ptr<ScanReader> openScans(const std::string& path, const std::string& label = "",
                                      const std::string& imagesFolder = "");
}  // namespace delio::io
