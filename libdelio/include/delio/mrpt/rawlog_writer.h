#pragma once
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "delio/earth/fix.h"
#include "delio/files/output.h"
#include "delio/formats/drive_meta.h"
#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/wheels.h"

namespace delio::io {
/** The Unix time that stands for second 0 of a drive whose own times start at 0: MRPT takes time 0
 *  for "no time". (2011-09-26 00:00 UTC, the first day of KITTI.) */
constexpr double kDriveEpoch_s = 1316995200.0;

/** KITTI's floats of a cloud: x y z intensity of each point, 0 where it has no intensities. */
std::vector<float> xyziOf(const mrpt::maps::CPointsMap& points);

/** Writes a drive as a rawlog of CObservationPointCloud in the observations-only format, with its
 *  side files. The rawlog is uncompressed (RawLogViewer needs that). Scans lie in
 *  `OUT_Images/NNNNNN.bin` (KITTI's float32 x y z intensity; a file or a link to one) or, embedded,
 *  in the rawlog. All of it lies in a PartialFolder until finish(): an unfinished drive leaves
 *  nothing behind, and a drive that was there before stays. Whenever the process is killed, there
 *  is the old drive or the new one or no OUT.rawlog, without which there is no drive. */
class RawlogWriter {
 public:
    /** `path` ends in .rawlog. Throws Error if the rawlog, OUT_Images or a side file exists and
     *  `force` is false, if the folder cannot be written, or another program writes the same drive.
     *  With `force` they are replaced. */
    RawlogWriter(const std::string& path, std::string label, bool embed, bool force);

    /** All paths of a drive at `path`, which finish() replaces. */
    static std::vector<std::string> outputsOf(const std::string& path);

    /** Appends a scan. `stamp_s`: seconds since `epoch_s`; `xyzi`: four floats a point. */
    void add(double stamp_s, double epoch_s, const std::vector<float>& xyzi);

    /** Appends a scan with all that it has: rings and times of its points in files beside its own,
     *  and the sensor's pose. */
    void add(const Scan& scan, double epoch_s);

    /** The same of another sensor, whose files begin with its label. scans() does not count it, and
     *  side files have no row of it. Not for embedded scans. */
    void addOther(const std::string& label, const Scan& scan, double epoch_s);

    /** Appends a scan that stays in `file`, which is in KITTI's format: OUT_Images holds a
     *  symbolic link to its absolute path. Not for embedded scans. Throws Error where that fails.
     */
    void addLinked(double stamp_s, double epoch_s, const std::string& file);

    /** Appends a sample of an IMU as a CObservationIMU with the label `imu`; `stamp_s` counts from
     *  `epoch_s`. */
    void add(const ImuSample& sample, double epoch_s);
    /** Appends a pose by wheels, with the label `odometry`: a CObservationOdometry where it is one
     *  in the plane and of the vehicle, otherwise a CObservationRobotPose. */
    void add(const OdometrySample& sample, double epoch_s);
    /** Appends a GNSS fix as a CObservationGPS with GGA; its stamp counts from `epoch_s`, an
     * antenna that is not known is at 0. `quality`: as GGA numbers it. */
    void add(const earth::Fix& fix, int quality, double epoch_s);
    /** The same with quality and HDOP by its covariance: as GGA has one number for it, no axis
     * becomes more certain. */
    void add(const earth::Fix& fix, double epoch_s);

    /** Writes one value per point of the next scan into `OUT_Images/NNNNNN` + extension. Throws
     *  Error where that fails. */
    template <typename Value>
    void addExtra(const std::string& extension, const std::vector<Value>& values) {
        makeImages();
        write(extraFile(extension), values.data(), values.size() * sizeof(Value));
    }

    /** Writes OUT.meta.yaml and, where the text is not empty, OUT.times.txt, OUT.calib.txt,
     *  OUT.poses.txt, OUT.faults.tsv, OUT.origin.txt (origin of a synthetic drive in its world),
     * OUT.imu.yaml (truth of its IMU), OUT.gnss.csv (truth of fixes), byte for byte as given; then
     * puts the drive in place of the old one. Throws Error where that fails; then the old one is
     * still there. */
    void finish(const DriveMeta& meta, const std::string& timesText, const std::string& calibText,
                const std::string& posesText, const std::string& faultsText = "",
                const std::string& originText = "", const std::string& imuText = "",
                const std::string& gnssText = "");

    std::size_t scans() const { return count_; }  //!< that were added

 private:
    /** Appends a scan that has no time or label yet. */
    void append(mrpt::obs::CObservationPointCloud& observation, double stamp_s, double epoch_s);
    void put(const mrpt::obs::CObservation& observation);
    /** Its points: in `OUT_Images` or embedded. */
    void setPoints(mrpt::obs::CObservationPointCloud& observation, const std::vector<float>& xyzi);

    /** Error naming the drive; for a full disk. */
    [[noreturn]] void giveUp() const;
    void makeImages() const;
    /** Of the scan to be added next, in the temporary folder. */
    std::string extraFile(const std::string& extension) const;
    void write(const std::string& file, const void* bytes, std::size_t count) const;

    std::string path_, label_, prefix_;  //!< of the names of files
    bool embed_;
    OutputLock lock_;
    PartialFolder partial_;
    std::string partialRawlog_, partialImages_;
    std::size_t count_ = 0;
    std::map<std::string, std::size_t> others_;  //!< scans of other sensors
    mrpt::io::CFileOutputStream out_;
};
}  // namespace delio::io
