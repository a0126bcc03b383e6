#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>

#include "delio/mrpt/rawlog_writer.h"
#include "drive.h"
#include "faults.h"
#include "gnss.h"
#include "imu.h"
#include "mount.h"
#include "ray_caster.h"
#include "scanner.h"
#include "scene.h"
#include "tile_window.h"
#include "traffic.h"
#include "traffic_caster.h"
#include "wheels.h"

namespace delio::synth {
struct DriveRequest {
    std::string output;  //!< OUT.rawlog
    SensorModel sensor;
    ScannerOptions scanner;
    Mount mount;
    std::size_t movers = 0;
    FaultRates faults;
    std::optional<GnssRequest> gnss;  //!< a receiver on the vehicle
    bool distort = false;  //!< every column is fired on the way: OUT_Images/NNNNNN.time says when
    bool labels = false;   //!< OUT_Images/NNNNNN.label says which points move
    std::optional<ImuModel> imu;       //!< recorded beside the scans
    std::optional<WheelModel> wheels;  //!< likewise
    std::optional<double> epoch_s;     //!< Unix time of scan 0; nothing: stamps start at 0
    /** Pose of a second sensor of the same model in the first one's frame. */
    std::optional<Eigen::Isometry3d> second;
    bool embed = false, force = false;

    /** Unix time of second 0 of the drive. */
    double secondZero() const { return epoch_s.value_or(io::kDriveEpoch_s); }
};

/** KITTI's Tr for the synthetic vehicle: coordinates of the LiDAR, mounted upright, to cam0's. */
Eigen::Isometry3d lidarToCam0();

/** Drives through a scene and writes what the sensor sees, with the truth: the rawlog and all of
 *  its side files. Memory does not grow with the drive but for the text of the side files. */
class DriveWriter {
 public:
    DriveWriter(const DriveRequest& request, const Scene& scene, const Drive& drive);

    /** The tool's exit code. */
    int write();

 private:
    void writeScan(std::size_t scan);
    void add(std::size_t scan, const ScanPoints& points);
    void addSecond(std::size_t scan);
    void addSamples(double stamp_s);
    ScanPoints simulate(std::size_t scan);
    std::string poseRow(std::size_t scan) const;
    std::string origin() const;
    std::string calibration() const;
    void finish();

    const DriveRequest& request_;
    const Drive& drive_;
    Traffic traffic_;
    TrafficCaster trafficCaster_;
    RayCaster caster_;
    TileWindow window_;
    Scanner scanner_;
    std::optional<Scanner> second_;
    io::RawlogWriter writer_;
    std::optional<Imu> imu_;
    std::optional<Wheels> wheels_;
    std::optional<GnssReceiver> gnss_;
    ScanPoints last_;  //!< what a repeated scan repeats
    std::string times_, poses_, faults_;
};
}  // namespace delio::synth
