#pragma once
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose3D.h>

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "delio/recordings/scan_reader.h"

namespace delio::io {
class GzInput;
class RawlogOdometry;

/** Reads the LiDAR scans of a rawlog, whatever class they were recorded as (see isScan()), bare or
 *  inside CSensoryFrames, embedded or in external files, and the samples of its first IMU
 *  (CObservationIMU) and of its first odometry (CObservationOdometry, CObservationRobotPose, or
 *  motions by odometry in CActionCollections). Rings and times of points are taken from
 *  `.ring` and `.time` files beside the external ones (synth2rawlog writes them), from packets and
 *  from range images; the drive's metadata come from the meta.yaml next to the rawlog, if it
 *  exists, and times count from its `epoch_unix_s`. Readers share nothing: several may run at once
 *  (MRPT's own folder of external files, setLazyLoadPathBase(), is neither used nor set). */
class RawlogReader : public ScanReader {
 public:
    /** `label`: the sensor to read; empty: that of the first scan in the rawlog.
     *  `imagesFolder`: where external files lie; empty: the folders that MRPT's programs look in,
     *  `DRIVE_Images` and `Images` beside the rawlog. Throws Error if the file cannot be opened or
     *  is empty, and as readDriveMeta(). */
    explicit RawlogReader(const std::string& path, std::string label = "",
                          std::string imagesFolder = "");
    ~RawlogReader() override;

    /** Throws Error where the rawlog is cut off or damaged (compressed data with a wrong checksum,
     *  objects that claim more memory than available), holds something that is no MRPT object or
     *  cannot be decoded, or an external file is missing or cut off (its message names the folders
     *  tried); after that the reader is at its end. */
    std::optional<Scan> next() override;
    bool skip() override;

    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return otherLabels_; }
    /** Nothing where the file is compressed. */
    std::optional<double> fraction() const override;
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    std::vector<ImuSample> takeImu() override { return std::exchange(imu_, {}); }
    std::vector<OdometrySample> takeOdometry() override;
    Recording recording() const override;
    earth::Fixes takeFixes() override;
    SideFile calibration() const override;
    SideFile truth() const override;

 private:
    /** A sensor without a label. */
    struct Unlabelled {
        std::string className;
        mrpt::poses::CPose3D pose;
    };

    mrpt::obs::CObservation::Ptr nextObservation();
    /** The sensor's label; of those without one the first's is empty, the others, one for each
     *  class and pose on the vehicle, are `unlabelled-2` and so on. */
    std::string nameOf(const mrpt::obs::CObservation& observation);
    bool readEntry();
    void accept(const mrpt::obs::CObservation::Ptr& observation);
    std::vector<std::string> imagesFolders() const;
    /** Where the extras of an embedded scan's points would lie, without the extension. */
    std::string embeddedStem(std::size_t scan) const;

    std::string path_, label_, imagesFolder_;
    bool chosen_;  //!< label_ is the sensor's; it may be empty
    std::vector<Unlabelled> unlabelled_;
    std::optional<DriveMeta> meta_;
    bool ended_ = false;
    std::size_t count_ = 0;
    std::unique_ptr<GzInput> in_;
    std::deque<mrpt::obs::CObservation::Ptr> pending_;
    std::vector<ImuSample> imu_;
    std::optional<std::string> imuLabel_;  //!< of the first one
    std::unique_ptr<RawlogOdometry> odometry_;
    std::set<std::string> otherLabels_;
    earth::Fixes fixes_;  //!< read, and not taken yet
};
}  // namespace delio::io
