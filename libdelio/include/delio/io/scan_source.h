#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "delio/scan/scan.h"

namespace delio::io {
class GzInput;

/** Gives the LiDAR scans of a rawlog one at a time, whatever class they were recorded as (see
 *  isScan()), bare or inside CSensoryFrames, embedded or in external files. Rings and times of
 *  points are taken from `.ring` and `.time` files beside the external ones (synth2rawlog writes
 *  them), from packets and from range images. Memory does not grow with the length of the
 *  rawlog. */
class ScanSource {
 public:
    /** `label`: the sensor to read; empty: that of the first scan in the rawlog.
     *  `imagesFolder`: where external files lie; empty: the folders that MRPT's programs look in,
     *  `DRIVE_Images` and `Images` beside the rawlog. Times are counted from `epoch_s` (Unix).
     *  Throws Error if the file cannot be opened. */
    explicit ScanSource(const std::string& rawlogPath, std::string label = "",
                        std::string imagesFolder = "", double epoch_s = 0);
    ~ScanSource();

    /** The next scan of the label, or nothing at the end of the rawlog. Throws Error where the
     *  rawlog is cut off or damaged (compressed data with a wrong checksum, objects that claim
     *  more memory than there is), holds something that is no MRPT object or cannot be decoded, or
     *  an external file is missing or cut off (its message names the folders tried); after that
     *  the source is at its end. */
    std::optional<Scan> next();

    /** Passes over the next scan without reading its points; false at the end. */
    bool skip();

    /** The label that is read; empty until the first scan was met. */
    const std::string& label() const { return label_; }
    /** Labels of other scans met so far; a caller may want to say that they were not used. */
    const std::set<std::string>& otherLabels() const { return otherLabels_; }
    /** Part of the file read so far, 0 to 1; nothing where the file is compressed. */
    std::optional<double> fraction() const;

 private:
    mrpt::obs::CObservation::Ptr nextObservation();
    bool readEntry();
    std::vector<std::string> imagesFolders() const;
    /** Where the extras of an embedded scan's points would lie, without the extension. */
    std::string embeddedStem(std::size_t scan) const;
    /** Returns the file that the points came from; empty where they are embedded. */
    std::string loadExternal(const mrpt::obs::CObservation& observation) const;

    std::string path_, label_, imagesFolder_;
    double epoch_s_;
    bool ended_ = false;
    std::size_t count_ = 0;
    std::unique_ptr<GzInput> in_;
    std::deque<mrpt::obs::CObservation::Ptr> pending_;
    std::set<std::string> otherLabels_;
};
}  // namespace delio::io
