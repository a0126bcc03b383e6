#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "delio/earth/fix.h"
#include "delio/formats/drive_meta.h"
#include "delio/odometry/imu.h"
#include "delio/odometry/scan.h"
#include "delio/odometry/wheels.h"

namespace delio::io {
/** Properties of a recording. */
struct Recording {
    std::string kind;                       //!< e.g. "ROS 1 bag, topic /points"
    std::string sensor;                     //!< e.g. "Velodyne VLP-16"; empty: not known
    std::optional<double> rate_hz;          //!< scans a second, where two were seen
    bool startsEmpty = false;               //!< the first scans have no points
    bool pointTimes = false;                //!< points come with the times they were measured at
    std::optional<bool> motionCompensated;  //!< by the recorder; nothing: it does not say
    bool compensationMeasured = false;      //!< from the points: the source does not say it
    bool compensationAssumed = false;       //!< because most recordings of that kind are so
    /** First scan found to be de-skewed although the first scans, of a standing vehicle, did not
     *  show it. */
    std::optional<std::size_t> compensatedAfterAll;
    std::string imu;                    //!< label or topic of the IMU; empty: none was met
    std::string odometry;               //!< the same of the wheels' odometry
    std::optional<std::size_t> scans;   //!< where they are counted without reading them
    std::vector<std::string> warnings;  //!< missing optional parts
    /** Scans and points that the reader ignored or corrected, one line per kind with the number;
     *  complete after the last scan. */
    std::vector<std::string> findings;
};

/** In one line: "Velodyne VLP-16, 10 Hz, points with times, not de-skewed by the recorder, 3213
 *  scans (pcap)". */
std::string describe(const Recording& recording);

/** What a live sensor sent, and what became of it so far. */
struct LiveReport {
    std::size_t packets = 0;       //!< UDP datagrams that were received
    std::size_t lostPackets = 0;   //!< that this machine lost because it was too slow
    std::size_t notRecorded = 0;   //!< that are missing in the recording: the disk was too slow
    std::size_t droppedScans = 0;  //!< that were not processed, for lack of time
};

/** Pose of a sensor, which maps its coordinates to those of a frame. */
struct SensorMount {
    std::string frame;                                       //!< e.g. "base_link"
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor to that frame
};

/** Reads the scans of one LiDAR of a drive in order, from any format. Memory does not grow with the
 *  length of the drive. */
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

    /** Samples of the recording's IMU that were read since the last call, in their order in the
     *  recording, stamped as the scans. Those of skipped scans are among them. Where they are not
     *  taken, the oldest are dropped. */
    virtual std::vector<ImuSample> takeImu() { return {}; }

    /** The same of the recording's wheels or other odometry of the vehicle. */
    virtual std::vector<OdometrySample> takeOdometry() { return {}; }

    /** Name of the sensor that is read (of a ROS bag: the topic); empty until its first scan was
     *  read. */
    virtual const std::string& label() const = 0;
    /** Other LiDARs found so far, which are ignored. */
    virtual const std::set<std::string>& otherLabels() const = 0;

    /** The sensor's pose in the root of the bag's /tf_static. Nothing where Scan::sensorPose is all
     *  that the source says. */
    virtual std::optional<SensorMount> mount() { return {}; }

    /** Label and pose in the vehicle of each sensor whose scans are merged, the first one first;
     *  empty: only one is read. */
    virtual std::vector<std::pair<std::string, Eigen::Isometry3d>> mergedSensors() const {
        return {};
    }

    /** Part of the drive read so far, 0 to 1; nothing where that is not known. */
    virtual std::optional<double> fraction() const = 0;

    /** Metadata of the drive; nothing if the source has none. */
    virtual const std::optional<DriveMeta>& meta() const = 0;

    /** Properties recognised so far; complete once the first scan was read. */
    virtual Recording recording() const = 0;

    /** GNSS fixes read since the last call, with stamps as those of the scans. They may lie ahead
     * of the scans, and are complete after the last one. */
    virtual earth::Fixes takeFixes() { return {}; }

    /** Of a live sensor; nothing for recordings. */
    virtual std::optional<LiveReport> live() const { return {}; }

    /** Unix time at which a live sensor's last packet of the scan came that next() gave last;
     *  nothing for recordings. */
    virtual std::optional<double> received_s() const { return {}; }

    /** KITTI's calib.txt: `Tr`. */
    virtual SideFile calibration() const { return {}; }
    /** KITTI's poses.txt: one row per scan, skipped ones included, in the cam0 frame. */
    virtual SideFile truth() const { return {}; }
};

/** Settings of a live sensor. */
struct LiveSettings {
    /** pcap that the packets are written to as they come; empty: none. Read with the same settings,
     *  it gives the same scans. */
    std::string record;
    double idle_s = 0;  //!< seconds without a packet that end the drive; 0: nothing does
    /** Scans that may wait for the odometry. Where there are more, some are dropped (ScanFeed). */
    std::size_t mostWaiting = 10;
    /** Asked 20 times a second, by another thread: true ends the drive. Null: it goes on. */
    std::function<bool()> isEnded;
    /** Gets warnings during the drive, from other threads. */
    std::function<void(const std::string&)> onWarning;
    std::uint16_t sensorHttpPort = 80;  //!< of an Ouster, which gives away its json there
};

/** A part of the own vehicle, whose points are left out: a box of the vehicle's frame, or a sector
 *  as a LiDAR sees it from its own origin. */
struct VehiclePart {
    Eigen::AlignedBox3d box = {};  //!< metres, vehicle's frame; empty: the part is the sector
    /** Azimuth at which the sector begins, degrees in the sensor's frame, from x towards y. */
    double azimuthFrom_deg = 0;
    double azimuthTo_deg = 0;      //!< where it ends, on towards y: 170 and -170 are 20 deg behind
    double elevationFrom_deg = 0;  //!< the lowest, above the sensor's xy plane
    double elevationTo_deg = 0;    //!< the highest
    double range_m = std::numeric_limits<double>::infinity();  //!< where the sector ends
    std::string sensor = {};  //!< label of the sector's LiDAR; empty: each one
    std::string name = {};    //!< in messages
};

/** The parts that `text` gives: a box XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX (metres in the vehicle's
 * frame), or a file with a line for each part, `box xmin ymin zmin xmax ymax zmax` or `sector
 * azimuth_from azimuth_to elevation_from elevation_to [range_max [sensor]]`; `#` begins a comment.
 * Throws Error, which names file and line, for something else. */
std::vector<VehiclePart> vehiclePartsIn(const std::string& text);

/** A recording and the settings to open it. */
struct ScanSource {
    /** A rawlog (see RawlogReader), KITTI odometry or raw folder, folder of .pcd, .ply, .bin, .txt
     *  or .csv, ROS 1 .bag, ROS 2 .db3, .mcap or the folder of either, pcap of a Velodyne, Ouster,
     *  Hesai or RoboSense, .osf of an Ouster; the format is detected from the content. "-": a
     *  rawlog or pcap from standard input. "udp://[ADDRESS:]PORT[,PORT]...": packets that a sensor
     *  sends to this machine (IPv4; ADDRESS is the machine's or a multicast group's). */
    std::string path;
    /** The sensor to read: a rawlog's sensorLabel, a bag's topic, the serial number in an .osf; of
     * a folder of .bin files the layout of their points. Empty: that of the first scan of a rawlog;
     * of a bag its only one; of an .osf its first; the layout that the first file has. Several,
     * with commas between them, or `all`: their scans are merged in the frame of the first. */
    std::string label;
    /** Where the files lie that a rawlog keeps outside of itself; empty: beside it. */
    std::string imagesFolder;
    /** The sensor's description: an Ouster's json, a Velodyne's calibration (.xml, .yaml). Empty:
     *  the .json beside the recording, what the recording holds, or the model's usual one. */
    std::string sensorFile;
    LiveSettings live = {};  //!< of "udp://..."
    /** Poses of the sensors in the vehicle, instead of the recording's: lines `LABEL x y z yaw
     * pitch roll`, metres and degrees, and of an IMU `imu x y z yaw pitch roll [OFFSET]`, see
     * ImuSample::offset_s. Empty: none. */
    std::string extrinsicsFile = {};
    /** The same by label, in place of the file's; empty: none. */
    std::map<std::string, Eigen::Isometry3d> extrinsics = {};
    /** Points of these parts of the own vehicle are left out. */
    std::vector<VehiclePart> vehicle = {};
};

/** True for "udp://...". */
bool isLive(const std::string& path);

/** What a program says of a LiDAR that the reader ignores. */
std::string warningOfOther(const std::string& label);

/** Opens `source` and reads its first three scans, so that all of recording() is known, and meta()
 *  also where the points had to be looked at for it. Throws Error if there is nothing to read, the
 *  format is unknown, or the metadata are invalid; a fault in these scans is thrown by next(). */
std::unique_ptr<ScanReader> openScans(const ScanSource& source);
/** The same with the members of ScanSource as arguments. */
std::unique_ptr<ScanReader> openScans(const std::string& path, const std::string& label = "",
                                      const std::string& imagesFolder = "");

/** Name of a drive: its file's name without the extension, or its folder's, with '?' for control
 *  characters; "live" for a live sensor. Throws Error if that is not a valid folder name ("..", of
 * `...rawlog`). */
std::string nameOfDrive(const std::string& path);
}  // namespace delio::io
