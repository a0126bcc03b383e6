#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/recordings/scan_reader.h"
#include "delio/run/run.h"

namespace delio::run {
/** What is used of a recording, and how it is read. */
struct PlaybackSettings {
    std::size_t start = 0;  //!< first scan, counted from 0
    std::size_t count = 0;  //!< number of scans; 0: all
    std::size_t every = 1;  //!< every n-th scan, at least 1
    bool imu = true;        //!< use its IMU
    bool odometry = true;   //!< use its wheel odometry
    bool gnss = true;       //!< use GNSS fixes
    std::string fixes;      //!< file with fixes that replace the recording's; empty: none
    /** Position of the GNSS antenna in the vehicle, in place of the recording's; metres. */
    std::optional<Eigen::Vector3d> antenna;
    bool readAhead = true;  //!< another thread reads the next scan while one is registered
    /** Asked between scans: true ends the playback. Null: it never ends early. */
    std::function<bool()> isInterrupted;
};

/** Plays a recording to a run: scans, IMU samples, GNSS fixes. */
class Playback {
 public:
    /** Reads the first scan. Throws Error as ScanReader::next(). The reader has to stay. */
    Playback(io::ScanReader& reader, PlaybackSettings settings);

    /** There is no scan after `start`, or reading it was interrupted. */
    bool isEmpty() const { return !now_.scan; }

    /** How far a drive has come. */
    struct Progress {
        std::optional<double> fraction;    //!< part of the recording that was read, 0 to 1
        std::optional<double> latency_ms;  //!< from a live sensor's last packet to the pose
    };
    /** Gets the result of each scan. */
    using OnScan = std::function<void(const RunRow&, const Progress&)>;

    /** Processes all scans of the settings. A fault in the recording ends the playback and becomes
     *  the run's fault; findings become warnings. Call it once. */
    void play(Run& run, const OnScan& onScan = {});

 private:
    struct Reading {
        std::optional<Scan> scan;              //!< nothing at the end
        std::vector<ImuSample> imu;            //!< that were read with it
        std::vector<OdometrySample> odometry;  //!< likewise
        std::optional<double> fraction, received_s;
    };
    bool isInterrupted() const { return settings_.isInterrupted && settings_.isInterrupted(); }
    Reading read(std::size_t passedOver);
    void processAll(Run& run, const OnScan& onScan);
    std::optional<double> latency_ms();
    void addFixes(Run& run);
    void addLive(Run& run);

    io::ScanReader& reader_;
    PlaybackSettings settings_;
    Reading now_;
    double read_ms_ = 0;
    std::vector<double> latencies_ms_;
};

/** Refines the poses of several LiDARs relative to the first one: this one's odometry alone makes
 *  a map, on which the points of the others have to lie; rotation first, then translation. The
 *  first sensor's pose in the vehicle stays. Reads the recording once per sensor. `onScan`: called
 *  after each scan of the first one. Throws Error as openScans(), and where `source` names fewer
 *  than two sensors. */
std::vector<CalibratedSensor> calibrateExtrinsics(
    const io::ScanSource& source, const Options& options, PlaybackSettings settings,
    const std::function<void(std::optional<double> fraction)>& onScan = {});

/** A warning for each sensor of the recording that is not read. */
std::vector<std::string> warningsOfOthers(const io::ScanReader& reader);
}  // namespace delio::run
