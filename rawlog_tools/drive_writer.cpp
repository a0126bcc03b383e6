#include "drive_writer.h"

#include <cmath>
#include <cstdio>

#include "cam0_pose.h"
#include "cli.h"
#include "delio/core/geometry.h"
#include "delio/formats/trajectory.h"
#include "delio/version.h"

namespace delio::synth {
namespace {
// KITTI's axes (x right, y down, z forward) and about its lever arm from LiDAR to cam0.
const char* const kCalib = "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";
const char* const kLabel = "velodyne";
const char* const kSecondLabel = "second";
constexpr std::uint64_t kSecondKey = 0x5EC0;
const char* const kFaultsHeader =
    "# Scans of the drive that did not arrive as they were. drive_scan counts the scans of the\n"
    "# drive (ten a second), scan those in the rawlog and the rows of times and poses, from 0.\n"
    "# dropped: nothing is in the rawlog, nor has it a row of times and poses (scan is -).\n"
    "# repeated: the points of the scan before it in the rawlog once more, under its own stamp;\n"
    "#   its pose is where the vehicle was at that stamp.\n"
    "# empty: no points.\n"
    "drive_scan\tscan\tkind\n";

std::string timeRow(double stamp_s) {
    char row[32];
    std::snprintf(row, sizeof(row), "%.6f\n", stamp_s);
    return row;
}
}  // namespace

Eigen::Isometry3d lidarToCam0() {
    Eigen::Matrix3d R;
    R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    return isometry(R, {0, -0.08, -0.27});
}

DriveWriter::DriveWriter(const DriveRequest& request, const Scene& scene, const Drive& drive)
    : request_(request),
      drive_(drive),
      traffic_(scene.road(), drive, request.movers, request.scanner.seed),
      trafficCaster_(traffic_),
      window_(scene, caster_),
      scanner_(caster_, &trafficCaster_, request.sensor, request.scanner),
      writer_(request.output, kLabel, request.embed, request.force),
      faults_(kFaultsHeader) {
    if (request.imu) imu_.emplace(*request.imu, drive, request.scanner.seed);
    if (request.wheels) wheels_.emplace(*request.wheels, drive, request.scanner.seed);
    if (request.second) {
        ScannerOptions options = request.scanner;
        options.seed += kSecondKey;  // noise of its own
        options.own.sensor = *request.second;
        second_.emplace(caster_, &trafficCaster_, request.sensor, options);
    }
    if (request.gnss)
        gnss_.emplace(
            *request.gnss, [this](double time_s) { return drive_.lidarPoseAt(time_s); },
            request.mount.pose().inverse());
}

int DriveWriter::write() {
    if (traffic_.size() < request_.movers)
        cli::warn("the road only has room for " + std::to_string(traffic_.size()) +
                  " road users instead of " + std::to_string(request_.movers));
    {
        cli::Progress progress("simulating", drive_.scans());
        for (std::size_t scan = 0; scan < drive_.scans(); ++scan) {
            if (cli::interrupted()) return cli::kExitInterrupted;
            writeScan(scan);
            progress.update(scan + 1);
        }
    }
    finish();
    return cli::kExitSuccess;
}

void DriveWriter::writeScan(std::size_t scan) {
    addSamples(kScanPeriod_s * static_cast<double>(scan));
    const Fault fault = faultOf(request_.faults, scan, request_.scanner.seed);
    if (fault != Fault::kNone) {
        const std::string written =
            fault == Fault::kDropped ? "-" : std::to_string(writer_.scans());
        faults_ += std::to_string(scan) + "\t" + written + "\t" + nameOf(fault) + "\n";
    }
    if (fault == Fault::kDropped) return;
    if (fault == Fault::kEmpty) last_ = {};
    if (fault == Fault::kNone) last_ = simulate(scan);
    add(scan, last_);
    if (second_) addSecond(scan);
}

ScanPoints DriveWriter::simulate(std::size_t scan) {
    window_.moveTo(drive_.station(scan));
    ScanPoints points = scanner_.scan(
        sweepOf(drive_, scan, request_.sensor, request_.distort, request_.scanner.seed), scan);
    request_.mount.turn(points);
    return points;
}

void DriveWriter::add(std::size_t scan, const ScanPoints& points) {
    writer_.addExtra(".ring", points.ring);
    if (request_.distort) writer_.addExtra(".time", points.time_s);
    if (request_.labels) writer_.addExtra(".label", points.label);
    const double stamp_s = kScanPeriod_s * static_cast<double>(scan);
    if (gnss_)
        gnss_->upTo(stamp_s, [&](const earth::Fix& fix) {
            writer_.add(fix, gnss_->quality(), request_.secondZero());
        });
    writer_.add(stamp_s, request_.secondZero(), points.xyzi);
    times_ += timeRow(request_.epoch_s.value_or(0) + stamp_s);
    poses_ += poseRow(scan);
}

/** Where points have times, the second sensor turns freely. */
void DriveWriter::addSecond(std::size_t scan) {
    constexpr double kLater_s = 0.037;
    const SecondSensor mounted{*request_.second, request_.distort ? kLater_s : 0};
    const Sweep sweep = sweepOf(drive_, scan, request_.sensor, request_.distort,
                                request_.scanner.seed + kSecondKey, mounted);
    const ScanPoints points = second_->scan(sweep, scan);
    Scan own;
    own.stamp_s = sweep.stamp_s;
    own.sensorPose = mounted.pose;
    own.rings = points.ring;
    if (request_.distort) own.times_s = points.time_s;
    const auto cloud = mrpt::maps::CPointsMapXYZI::Create();
    cloud->resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const float* p = &points.xyzi[4 * i];
        cloud->setPointFast(i, p[0], p[1], p[2]);
        cloud->setPointIntensity(i, p[3]);
    }
    own.points = cloud;
    writer_.addOther(kSecondLabel, own, request_.secondZero());
}

/** Of IMU and wheels, up to this stamp. */
void DriveWriter::addSamples(double stamp_s) {
    const auto add = [&](auto& source) {
        if (!source) return;
        while (const auto sample = source->next(stamp_s))
            writer_.add(*sample, request_.secondZero());
    };
    add(imu_);
    add(wheels_);
}

/** Pose of cam0 in the world at the first scan, which relates two drives through one world. */
std::string DriveWriter::origin() const {
    return io::kittiRow(cam0PoseOf(drive_.lidarPose(0), lidarToCam0()));
}

/** Where the LiDAR is at the scan's stamp, relative to the first scan, as cam0's: a row of KITTI's
 *  poses.txt. How the LiDAR is turned does not move cam0. */
std::string DriveWriter::poseRow(std::size_t scan) const {
    Eigen::Isometry3d relative = Eigen::Isometry3d::Identity();
    if (scan > 0)  // the first is the identity to the last digit
        relative = drive_.lidarPose(0).inverse() * drive_.lidarPose(scan);
    return io::kittiRow(cam0PoseOf(relative, lidarToCam0()));
}

std::string DriveWriter::calibration() const {
    if (request_.mount.isUpright()) return kCalib;
    return "Tr: " + io::kittiRow(lidarToCam0() * request_.mount.pose());
}

void DriveWriter::finish() {
    constexpr double kAfter_s = 0.3;
    addSamples(kScanPeriod_s * static_cast<double>(drive_.scans()) + kAfter_s);
    io::DriveMeta meta;
    meta.sensorModel = request_.sensor.name;
    meta.source = "synthetic";
    meta.motionCompensated = !request_.distort;
    meta.epoch_s = request_.epoch_s ? 0 : io::kDriveEpoch_s;
    meta.generator = std::string("synth2rawlog 2 (delio ") + kVersion + ")";
    writer_.finish(meta, times_, calibration(), poses_, faults_, origin(),
                   imu_ ? imu_->truth() : "", gnss_ ? gnss_->truth() : "");
    cli::inform("wrote " + std::to_string(writer_.scans()) + " scans, " +
                std::to_string(
                    std::lround(std::abs(drive_.station(drive_.scans() - 1) - drive_.station(0)))) +
                " m, to '" + request_.output + "'");
}
}  // namespace delio::synth
