#pragma once
#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace delio::io {
/** Poses along a drive, in order of time: each maps the coordinates of the moving frame to those
 *  of the frame of the first pose (or of the world, if the file says so). */
struct Trajectory {
    std::vector<Eigen::Isometry3d> poses;  //!< metres
    std::vector<double> stamps_s;  //!< one per pose, or empty where the file has none (KITTI)
};

/** Reads a pose file: KITTI (12 numbers per line, row-major 3x4) or TUM (t x y z qx qy qz qw; lines
 *  that start with '#' are skipped), distinguished by the count of numbers. Rotations are
 *  orthonormalised. Trailing spaces, empty lines and CR are accepted. Throws Error with file and
 *  line for anything else: missing or empty file, wrong count of numbers, text, NaN, a 3x3 part
 *  that is not a rotation (off by more than 1e-2), stamps that do not increase. */
Trajectory readTrajectory(const std::string& path);
/** The same of a text; `name` is what errors call it. */
Trajectory trajectoryIn(const std::string& text, const std::string& name);

/** A pose as KITTI writes it: 12 numbers, row-major 3x4, with the digits that give the same doubles
 *  back, and a line feed. */
std::string kittiRow(const Eigen::Isometry3d& pose);

/** Writes a kittiRow() for each pose. */
void writeKitti(const Trajectory& trajectory, const std::string& path);

/** A pose as TUM writes it, `t x y z qx qy qz qw`, in the same way. */
std::string tumRow(double stamp_s, const Eigen::Isometry3d& pose);

/** Writes `t x y z qx qy qz qw` with qw of 0 or more; needs stamps. */
void writeTum(const Trajectory& trajectory, const std::string& path);

/** Reads times.txt: one time in seconds per line, as in KITTI. Throws Error as above. */
std::vector<double> readTimes(const std::string& path);

/** KITTI's calib.txt: `Tr`, which maps LiDAR coordinates to cam0 coordinates. */
struct Calibration {
    bool hasTr = false;                                    //!< false: the file has no Tr
    Eigen::Isometry3d Tr = Eigen::Isometry3d::Identity();  //!< LiDAR to cam0, metres
};

/** Throws Error for a missing file or a malformed Tr; a file without Tr gives hasTr = false. */
Calibration readCalibration(const std::string& path);
/** The same of a text; `name` is what errors call it. */
Calibration calibrationIn(const std::string& text, const std::string& name);

/** Tr * T * Tr^-1 for each pose: converts a trajectory of the LiDAR to cam0. */
Trajectory lidarToCam0(const Trajectory& lidar, const Eigen::Isometry3d& Tr);
}  // namespace delio::io
