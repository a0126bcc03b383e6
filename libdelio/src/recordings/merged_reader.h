#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "delio/recordings/scan_reader.h"
#include "extrinsics.h"
#include "findings.h"

namespace delio::io {
/** A sensor of a MergedReader. */
struct MergedSensor {
    std::string label;  //!< as it was asked for
    std::unique_ptr<ScanReader> reader;
};

/** Merges the scans of several LiDARs into scans in the first one's frame. A scan of the first one
 *  sets the interval, which ends where its next scan begins. Points of the others are taken by
 *  their own times; scans without point times go whole to the nearest stamp. While the first sensor
 *  sends nothing, the next one in order replaces it. IMU, fixes and side files are those of the
 *  first. With one sensor, only its pose changes. */
class MergedReader : public ScanReader {
 public:
    /** `extrinsics`: of no LiDAR, or of every one. Throws Error where a sensor has no scans, or its
     *  pose relative to the first one is not known. */
    MergedReader(std::vector<MergedSensor> sensors, const ExtrinsicsFile& extrinsics);

    std::optional<Scan> next() override;
    bool skip() override { return next().has_value(); }
    std::vector<ImuSample> takeImu() override;
    std::vector<OdometrySample> takeOdometry() override {
        return sensors_.front().reader->takeOdometry();
    }
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return others_; }
    /** As their first scans say, where nothing else does. */
    std::vector<std::pair<std::string, Eigen::Isometry3d>> mergedSensors() const override {
        return poses_;
    }
    std::optional<double> fraction() const override;
    const std::optional<DriveMeta>& meta() const override {
        return sensors_.front().reader->meta();
    }
    Recording recording() const override;
    earth::Fixes takeFixes() override { return sensors_.front().reader->takeFixes(); }
    SideFile calibration() const override { return sensors_.front().reader->calibration(); }
    SideFile truth() const override { return sensors_.front().reader->truth(); }

 private:
    struct Sensor {
        std::string label;
        std::unique_ptr<ScanReader> reader;
        std::optional<Eigen::Isometry3d> pose;  //!< in the vehicle; nothing: its scans say it
        std::deque<Scan> ahead;                 //!< two, where there are
        bool isRest = false;                    //!< the first of them is what was left of a scan
        bool ended = false;
        std::size_t seen = 0;  //!< merged scans up to the latest one that has points of it
    };
    /** Time that a merged scan covers, from second 0 of the drive. */
    struct Interval {
        double begin_s, end_s;
        bool cuts;  //!< points of the others are cut there; false: whole scans, by their stamps
    };

    void takePoses(const Extrinsics& poses);
    void fill(Sensor& sensor);
    Sensor* driver();
    Interval intervalOf(const Sensor& driver) const;
    void learnInterval(double stamp_s);
    void take(Sensor& sensor, const Scan& own, const Interval& interval, Scan& merged);
    template <typename IsWanted>
    void append(const Scan& scan, const Sensor& sensor, Scan& merged, const IsWanted& isWanted);
    void note(Sensor& sensor, std::size_t scan);
    Eigen::Isometry3d poseOf(const Sensor& sensor, const Scan& scan) const;

    std::vector<Sensor> sensors_;
    std::optional<ImuMount> imu_;  //!< in place of what the samples say
    std::vector<std::pair<std::string, Eigen::Isometry3d>> poses_;  //!< of the sensors
    std::string label_;
    std::set<std::string> others_;  //!< that are not merged
    double interval_s_ = 0;         //!< between two scans, usually; 0: not known
    std::deque<double> intervals_s_;
    std::optional<double> latestStamp_s_;
    Eigen::Isometry3d reference_;    //!< pose of the first sensor among the others
    Eigen::Isometry3d vehiclePose_;  //!< its pose in the vehicle
    std::size_t count_ = 0;          //!< merged scans
    std::size_t replaced_ = 0;       //!< that the first sensor did not set
    std::exception_ptr fault_;       //!< comes after the last scan of the others
    Findings findings_;
    std::vector<std::string> gaps_, warnings_;
};
}  // namespace delio::io
