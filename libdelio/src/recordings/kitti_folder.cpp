#include "kitti_folder.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/formats/georeference.h"
#include "delio/formats/trajectory.h"
#include "delio/mrpt/rawlog_writer.h"
#include "delio/recordings/kitti_drive.h"
#include "files/input_file.h"
#include "formats/bin_cloud.h"
#include "formats/number_line.h"
#include "mrpt/clock.h"
#include "sources.h"

namespace delio::io {
namespace fs = std::filesystem;

// Poses are composed by MRPT: another order of sums would change the last digits of what is
// written.
using mrpt::poses::CPose3D;

namespace {
/** KITTI numbers its files; where one is missing (raw drive 0009 has a gap) its row stays, so rows
 *  are found by the number. */
std::size_t numberOf(const fs::path& file) {
    const std::string stem = file.stem().string();
    if (stem.empty() || stem.size() > 18 || stem.find_first_not_of("0123456789") != stem.npos)
        throw Error("'" + file.string() + "': KITTI scans must have a number as name");
    return std::stoul(stem);
}

std::vector<fs::path> scansIn(const fs::path& folder) {
    std::vector<fs::path> scans;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".bin") scans.push_back(entry.path());
    std::sort(scans.begin(), scans.end(),
              [](const fs::path& a, const fs::path& b) { return numberOf(a) < numberOf(b); });
    if (scans.empty()) throw Error("'" + folder.string() + "' contains no .bin file: no scans");
    return scans;
}

std::string textOf(const fs::path& file) {
    isFileThere(file);
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error("cannot read '" + file.string() + "'");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::vector<std::string> linesOf(const fs::path& file) {
    std::istringstream text(textOf(file));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
}

/** The lines that readTimes() and readTrajectory() make rows of. */
std::vector<std::string> numberLinesOf(const fs::path& file) {
    auto lines = linesOf(file);
    lines.erase(std::remove_if(lines.begin(), lines.end(),
                               [](const std::string& line) {
                                   return line[0] == '#' ||
                                          line.find_first_not_of(" \t\r,") == line.npos;
                               }),
                lines.end());
    return lines;
}

/** The rows that belong to the scans. */
template <typename Row>
std::vector<Row> rowsOf(const std::vector<fs::path>& scans, const std::vector<Row>& rows,
                        const fs::path& file) {
    std::vector<Row> chosen;
    for (const auto& scan : scans) {
        const std::size_t number = numberOf(scan);
        if (number >= rows.size())
            throw Error(
                "'" + file.string() + "' has " + std::to_string(rows.size()) + " rows but scan " +
                scan.filename().string() + " needs one; " +
                (chosen.empty() ? "" : "use --count " + std::to_string(chosen.size()) + " or ") +
                "complete the file");
        chosen.push_back(rows[number]);
    }
    return chosen;
}

/** The folder by all its names, also where it is given as `.` or `00/`. */
fs::path wholePath(const fs::path& folder) {
    return fs::absolute(folder / "").lexically_normal().parent_path();
}

void useNominalTimes(KittiDrive& drive, const std::string& missing) {
    drive.nominalTimes = true;
    drive.warnings.push_back(missing + " not found: assuming 0.1 s between scans");
    for (const auto& scan : drive.scans)
        drive.times_s.push_back(0.1 * static_cast<double>(numberOf(scan)));
}

void takeKittisSensor(DriveMeta& meta) {
    meta.sensorModel = "HDL-64E";
    // Found by IMLS-SLAM and used by KISS-ICP, CT-ICP and MOLA: KITTI's calibration of the lasers'
    // vertical angles is off by this much.
    meta.verticalCorrectionDeg = 0.205;
}

void readOdometrySequence(const fs::path& folder, KittiDrive& drive) {
    drive.meta.source = "kitti-odometry";
    drive.meta.epoch_s = kDriveEpoch_s;
    const fs::path times = folder / "times.txt";
    if (fs::exists(times)) {
        drive.times_s = rowsOf(drive.scans, readTimes(times.string()), times);
        drive.timeRows = rowsOf(drive.scans, numberLinesOf(times), times);
    } else {
        useNominalTimes(drive, "'" + times.string() + "'");
    }
    const fs::path calib = folder / "calib.txt";
    drive.calibName = calib.string();
    if (fs::exists(calib)) {
        if (!readCalibration(calib.string()).hasTr)
            drive.warnings.push_back("'" + calib.string() +
                                     "' has no Tr: no results in the cam0 frame");
        drive.calibText = textOf(calib);
        // Scans of other sensors come in KITTI's format, too, but not with its cameras.
        if (("\n" + drive.calibText).find("\nP0:") != std::string::npos)
            takeKittisSensor(drive.meta);
    } else {
        drive.warnings.push_back("'" + calib.string() +
                                 "' not found: assuming that this is not KITTI's own HDL-64E; if "
                                 "it is, add --set scan.vertical_correction_deg=0.205");
    }
    // KITTI's own layout has dataset/sequences/NN and dataset/poses/NN.txt.
    const fs::path whole = wholePath(folder);
    for (const auto& poses : {folder / "poses.txt", whole.parent_path().parent_path() / "poses" /
                                                        (whole.filename().string() + ".txt")}) {
        if (drive.posesName.empty()) drive.posesName = poses.string();
        if (!fs::exists(poses)) continue;
        drive.posesName = poses.string();
        readTrajectory(poses.string());  // for its checks; the rows travel as they are
        drive.poseRows = rowsOf(drive.scans, numberLinesOf(poses), poses);
        break;
    }
}

/** Unix seconds of a line of timestamps.txt. */
double stampOf(const std::string& line, const fs::path& file) {
    const auto stamp = unixTimeOfDate(line);
    if (!stamp) throw Error("'" + file.string() + "': '" + line + "' is not a date and time");
    return *stamp;
}

using Rows = std::map<std::string, std::vector<double>>;

/** KITTI raw's calibration files: `KEY: numbers`; other rows (dates) are passed over. */
Rows readRawCalibration(const fs::path& file) {
    Rows rows;
    for (const auto& line : linesOf(file)) {
        const auto colon = line.find(':');
        if (colon == line.npos) continue;
        rows[line.substr(0, colon)] = delio::numbersIn(std::string_view(line).substr(colon + 1));
    }
    return rows;
}

CPose3D rigid(const Rows& rows, const std::string& R, const std::string& T, const fs::path& file) {
    static const std::vector<double> none(3, 0.0);
    const auto rotation = rows.find(R);
    const auto found = rows.find(T);
    const auto& shift = T.empty() ? none : found == rows.end() ? none : found->second;
    if (rotation == rows.end() || rotation->second.size() != 9 || shift.size() != 3 ||
        (!T.empty() && found == rows.end()))
        throw Error("'" + file.string() + "' has no complete " + R +
                    (T.empty() ? "" : " and " + T));
    mrpt::math::CMatrixDouble33 m;
    for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = rotation->second[static_cast<std::size_t>(i)];
    return {m, shift};
}

/** Pose of the OXTS unit in KITTI's Mercator world; `scale` is the cosine of the first latitude. */
CPose3D poseOfOxts(const fs::path& file, double& scale) {
    const auto row = delio::numbersIn(textOf(file));
    if (row.size() < 6)
        throw Error("'" + file.string() + "' does not start with six numbers, as OXTS files do");
    const double lat = row[0], lon = row[1], alt = row[2], roll = row[3], pitch = row[4],
                 yaw = row[5];
    constexpr double earthRadius_m = 6378137.0;
    if (scale == 0) scale = std::cos(lat * M_PI / 180);
    const double x = scale * earthRadius_m * lon * M_PI / 180;
    const double y = scale * earthRadius_m * std::log(std::tan(M_PI * (90 + lat) / 360));
    return CPose3D::FromXYZYawPitchRoll(x, y, alt, yaw, pitch, roll);
}

void readOxts(const fs::path& folder, const CPose3D& imuToCam0, KittiDrive& drive) {
    double scale = 0;
    CPose3D first;
    for (const auto& scan : drive.scans) {
        const fs::path file = folder / "oxts" / "data" / (scan.stem().string() + ".txt");
        if (!fs::exists(file)) {
            drive.warnings.push_back("'" + file.string() + "' not found: no ground truth");
            drive.poseRows.clear();
            return;
        }
        const CPose3D imu = poseOfOxts(file, scale);
        if (drive.poseRows.empty()) first = imu;
        drive.poseRows.push_back(kittiRow(fromMrpt(imuToCam0 + (imu - first) + (-imuToCam0))));
        drive.poseRows.back().pop_back();  // rows are kept without their line feed
    }
}

/** The positions of the OXTS unit, which lies at `imu` in the LiDAR's frame. */
void readOxtsFixes(const fs::path& folder, const CPose3D& imu, KittiDrive& drive) {
    const fs::path times = folder / "oxts" / "timestamps.txt";
    const auto lines = fs::exists(times) ? linesOf(times) : std::vector<std::string>{};
    for (std::size_t i = 0; i < drive.scans.size(); ++i) {
        const fs::path file = folder / "oxts" / "data" / (drive.scans[i].stem().string() + ".txt");
        if (!fs::exists(file)) continue;
        const auto row = delio::numbersIn(textOf(file));
        constexpr std::size_t kAccuracy = 23;  // m
        if (row.size() < 3) continue;
        earth::Fix fix;
        const std::size_t number = numberOf(drive.scans[i]);
        const auto date =
            number < lines.size() ? unixTimeOfDate(lines[number]) : std::optional<double>{};
        fix.stamp_s = date ? *date - drive.meta.epoch_s : drive.times_s[i];
        fix.place = {row[0], row[1], row[2]};
        const double sigma_m = row.size() > kAccuracy && row[kAccuracy] > 0 ? row[kAccuracy] : 1;
        fix.covariance *= sigma_m * sigma_m;
        fix.antenna = fromMrpt(imu).translation();
        drive.fixes.push_back(fix);
    }
}

/** A row of OXTS as a sample of its IMU (x forward, y left, z up); nothing where it is too short.
 */
std::optional<ImuSample> imuSampleOf(const fs::path& file) {
    constexpr std::size_t kAcceleration = 11, kRate = 17;  // m/s^2, rad/s
    if (!fs::exists(file)) return {};
    const auto row = delio::numbersIn(textOf(file));
    if (row.size() < kRate + 3) return {};
    ImuSample sample;
    sample.acceleration_mps2 = Eigen::Vector3d(row.data() + kAcceleration);
    sample.rate_radps = Eigen::Vector3d(row.data() + kRate);
    return sample;
}

/** Samples of all rows about the scans; without timestamps.txt those of the scans. */
void readOxtsImu(const fs::path& folder, const CPose3D& imu, KittiDrive& drive) {
    constexpr double kMargin_s = 1;
    const auto add = [&](const std::string& name, double stamp_s) {
        auto sample = imuSampleOf(folder / "oxts" / "data" / (name + ".txt"));
        if (!sample) return;
        sample->stamp_s = stamp_s;
        sample->sensorPose = fromMrpt(imu);
        drive.imu.push_back(*sample);
    };
    const fs::path times = folder / "oxts" / "timestamps.txt";
    if (!fs::exists(times)) {
        for (std::size_t i = 0; i < drive.scans.size(); ++i)
            add(drive.scans[i].stem().string(), drive.times_s[i]);
        return;
    }
    const auto lines = linesOf(times);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const auto date = unixTimeOfDate(lines[i]);
        if (!date) continue;
        const double stamp_s = *date - drive.meta.epoch_s;
        const std::string number = std::to_string(i);
        if (stamp_s < drive.times_s.front() - kMargin_s ||
            stamp_s > drive.times_s.back() + kMargin_s || number.size() > 10)
            continue;
        add(std::string(10 - number.size(), '0') + number, stamp_s);
    }
}

void readRawDrive(const fs::path& folder, KittiDrive& drive) {
    drive.meta.source = "kitti-raw";
    takeKittisSensor(drive.meta);
    const fs::path times = folder / "velodyne_points" / "timestamps.txt";
    if (fs::exists(times)) {
        // Where a scan is missing its line is empty (raw drive 0009).
        const auto lines = rowsOf(drive.scans, linesOf(times), times);
        drive.meta.epoch_s = stampOf(lines.front(), times);
        for (const auto& line : lines)
            drive.times_s.push_back(stampOf(line, times) - drive.meta.epoch_s);
    } else {
        drive.meta.epoch_s = kDriveEpoch_s;
        useNominalTimes(drive, "'" + times.string() + "'");
    }
    const fs::path date = wholePath(folder).parent_path();
    const fs::path veloToCam = date / "calib_velo_to_cam.txt";
    const fs::path camToCam = date / "calib_cam_to_cam.txt";
    const fs::path imuToVelo = date / "calib_imu_to_velo.txt";
    drive.calibName = veloToCam.string();
    drive.posesName = (folder / "oxts").string();
    if (!fs::exists(veloToCam) || !fs::exists(camToCam)) {
        drive.warnings.push_back("'" + veloToCam.string() + "' or '" + camToCam.string() +
                                 "' not found: no calibration and no ground truth");
        return;
    }
    const CPose3D Tr = rigid(readRawCalibration(camToCam), "R_rect_00", "", camToCam) +
                       rigid(readRawCalibration(veloToCam), "R", "T", veloToCam);
    drive.calibText = "Tr: " + kittiRow(fromMrpt(Tr));
    if (!fs::exists(folder / "oxts") || !fs::exists(imuToVelo)) return;
    const CPose3D imu = rigid(readRawCalibration(imuToVelo), "R", "T", imuToVelo);
    readOxts(folder, Tr + imu, drive);
    readOxtsFixes(folder, imu, drive);
    readOxtsImu(folder, imu, drive);
}
}  // namespace

fs::path kittiFolderOf(const fs::path& folder) {
    const fs::path whole = wholePath(folder);
    fs::path above = whole.parent_path();
    if (whole.filename() == "data" && above.filename() == "velodyne_points")
        return above.parent_path();
    if (whole.filename() == "velodyne_points") return above;
    if (whole.filename() == "velodyne")
        for (const char* name : {"calib.txt", "times.txt", "poses.txt"})
            if (fs::exists(above / name)) return above;
    return folder;
}

KittiDrive openKittiDrive(const fs::path& folder, std::size_t start, std::size_t count) {
    if (!fs::is_directory(folder))
        throw Error("'" + folder.string() + "' is not a folder; give a KITTI sequence or drive");
    const bool raw = fs::is_directory(folder / "velodyne_points" / "data");
    const fs::path scanFolder = raw ? folder / "velodyne_points" / "data" : folder / "velodyne";
    if (!fs::is_directory(scanFolder))
        throw Error("'" + folder.string() +
                    "' has neither velodyne/ (KITTI odometry) nor velodyne_points/data/ (raw)");
    KittiDrive drive;
    drive.scans = scansIn(scanFolder);
    if (start >= drive.scans.size())
        throw Error("'" + folder.string() + "' has " + std::to_string(drive.scans.size()) +
                    " scans; none left after --start " + std::to_string(start) + " on");
    const auto begin = drive.scans.begin() + static_cast<std::ptrdiff_t>(start);
    const std::size_t left = drive.scans.size() - start;
    const std::size_t used = count == 0 ? left : std::min(count, left);
    drive.scans = {begin, begin + static_cast<std::ptrdiff_t>(used)};
    drive.meta.motionCompensated = !raw;
    if (raw)
        readRawDrive(folder, drive);
    else
        readOdometrySequence(folder, drive);
    return drive;
}

namespace {
/** KITTI's format: float x, y, z and intensity of each point. */
mrpt::maps::CPointsMap::Ptr readPoints(const fs::path& file) {
    const auto bytes = bytesOfFile(file);
    constexpr std::size_t kPoint = 4 * sizeof(float);
    refuseOtherLayout(file, bytes);
    if (bytes.size() % kPoint != 0)
        throw Error("'" + file.string() + "' is cut off: its size (" +
                    std::to_string(bytes.size()) + " bytes) is not a multiple of 16");
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(bytes.size() / kPoint);
    for (std::size_t i = 0; i < points->size(); ++i) {
        float p[4];
        std::memcpy(p, bytes.data() + i * kPoint, kPoint);
        points->setPointFast(i, p[0], p[1], p[2]);
        points->setPointIntensity(i, p[3]);
    }
    points->mark_as_modified();
    return points;
}
}  // namespace

KittiReader::KittiReader(const fs::path& folder)
    : FilesReader("velodyne"),
      drive_(openKittiDrive(kittiFolderOf(folder), 0, 0)),
      meta_(drive_.meta),
      fixesFile_(fixesBeside(kittiFolderOf(folder))) {
    setImu(imuBeside(kittiFolderOf(folder)));
}

Recording KittiReader::recording() const {
    Recording recording;
    recording.kind = meta_->source == "kitti-raw" ? "KITTI raw" : "KITTI odometry";
    if (drive_.nominalTimes) recording.kind += ", nominal times";
    if (hasImu()) recording.imu = "imu.csv";
    if (meta_->sensorModel != "unknown") recording.sensor = meta_->sensorModel;
    recording.motionCompensated = meta_->motionCompensated;
    // KITTI's own scans are known to be, those of another sensor in its format are not.
    recording.compensationAssumed = meta_->motionCompensated && recording.sensor.empty();
    recording.scans = drive_.scans.size();
    recording.warnings = drive_.warnings;
    return recording;
}

SideFile KittiReader::truth() const {
    SideFile truth{drive_.posesName, ""};
    for (const auto& row : drive_.poseRows) truth.text += row + "\n";
    return truth;
}

earth::Fixes KittiReader::takeFixes() {
    auto fixes = std::exchange(drive_.fixes, {});
    const auto file = std::exchange(fixesFile_, {});
    if (!file) return fixes;
    fixes = readFixes(*file);
    countFrom(meta_->epoch_s, fixes);
    return fixes;
}

Scan KittiReader::read(std::size_t index) {
    Scan scan;
    scan.points = readPoints(drive_.scans[index]);
    scan.time = timeOf(drive_.times_s[index], meta_->epoch_s);
    scan.stamp_s = secondsSince(meta_->epoch_s, scan.time);
    return scan;
}

bool isKittiFolder(const fs::path& folder) {
    const fs::path drive = kittiFolderOf(folder);
    return fs::is_directory(drive / "velodyne") ||
           fs::is_directory(drive / "velodyne_points" / "data");
}

std::unique_ptr<ScanReader> openKittiFolder(const ScanSource& source) {
    return std::make_unique<KittiReader>(source.path);
}
}  // namespace delio::io
