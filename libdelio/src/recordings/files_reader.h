#pragma once
#include <filesystem>
#include <utility>
#include <vector>

#include "delio/recordings/scan_reader.h"

namespace delio::io {
/** Reads scans that lie in a file each: what such readers share. */
class FilesReader : public ScanReader {
 public:
    std::optional<Scan> next() override;
    bool skip() override;
    std::vector<ImuSample> takeImu() override;
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return otherLabels_; }
    std::optional<double> fraction() const override;

 protected:
    explicit FilesReader(std::string label) : label_(std::move(label)) {}
    /** The samples of an IMU beside the scans, in the order of their stamps. */
    void setImu(std::vector<ImuSample> samples) { imu_ = std::move(samples); }
    bool hasImu() const { return !imu_.empty(); }
    /** The files, in the order of the scans. */
    virtual const std::vector<std::filesystem::path>& files() const = 0;
    /** Points and times of the `index`-th scan. Throws Error, which names the file. */
    virtual Scan read(std::size_t index) = 0;

 private:
    std::string label_;
    std::set<std::string> otherLabels_;  // none
    std::size_t count_ = 0;
    std::vector<ImuSample> imu_;
    std::size_t takenImu_ = 0;
    double latest_s_ = 0;  //!< stamp of the latest scan
};

/** When the scans of a folder were taken. */
struct ScanTimes {
    std::vector<double> stamps_s;  //!< one per scan; they need not rise
    bool nominal = false;          //!< not known: taken as 0.1 s apart
    /** Unix time of second 0: 0 where the stamps are Unix times, kDriveEpoch_s where they start
     *  near 0, which MRPT takes for no time. */
    double epoch_s = 0;
};

/** True for a file that lists times: times.txt, timestamps.txt, times.csv. */
bool isTimesFile(const std::filesystem::path& file);

/** The samples in imu.csv in `folder` or in the folder above; empty without that file. A row has
 *  the time (as the scans' times; Unix times may be in milli-, micro- or nanoseconds), the angular
 *  velocity (rad/s), and optionally the acceleration (m/s^2): 4 or 7 numbers. A first row without
 *  numbers and rows that begin with # are passed over. Sorted by time. Throws Error, which names
 *  the file and the line, for other rows. */
std::vector<ImuSample> imuBeside(const std::filesystem::path& folder);

/** Times of `scans`, which lie in `folder`: those of a times file there or in the folder above
 *  (seconds, or where they are large milli-, micro- or nanoseconds, or dates as KITTI raw has them;
 *  one a line), those that the files are named after (Unix time: 1616513421.123456,
 *  1616513421_123456000, 1616513421123456), or nominal ones, the scan's place times 0.1 s. Sorts
 *  `scans` by time where they are named after it. Throws Error for a times file that does not
 *  fit. */
ScanTimes timesOf(const std::filesystem::path& folder, std::vector<std::filesystem::path>& scans);
}  // namespace delio::io
