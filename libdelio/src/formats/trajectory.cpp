#include "delio/formats/trajectory.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <ostream>
#include <sstream>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/files/output.h"

namespace delio::io {
namespace {
std::string at(const std::string& path, std::size_t line) {
    return "'" + path + "', line " + std::to_string(line);
}

bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == ','; }

/** The numbers of one line; throws for anything that is not one. */
std::vector<double> numbersOf(const std::string& text, const std::string& where) {
    std::vector<double> numbers;
    const auto end = text.end();
    for (auto p = text.begin();;) {
        p = std::find_if_not(p, end, isSpace);
        if (p == end) return numbers;
        if (*p == '+') ++p;
        const auto next = std::find_if(p, end, isSpace);
        const auto number = numberIn<double>(std::string(p, next));
        if (!number || !std::isfinite(*number))
            throw Error(where + ": expected a finite number at '" +
                        std::string(p, end).substr(0, 20) + "'");
        numbers.push_back(*number);
        p = next;
    }
}

/** Calls `use(numbers, where)` for every line with numbers; throws if there is no such line. */
template <typename Use>
void forEachLine(std::istream& in, const std::string& path, const Use& use) {
    std::string text;
    bool any = false;
    for (std::size_t line = 1; std::getline(in, text); ++line) {
        if (!text.empty() && text[0] == '#') continue;
        const std::string where = at(path, line);
        const auto numbers = numbersOf(text, where);
        if (numbers.empty()) continue;
        use(numbers, where);
        any = true;
    }
    if (in.bad()) throw Error("cannot read '" + path + "': reading failed (a folder?)");
    if (!any) throw Error("'" + path + "' is empty");
}

std::ifstream opened(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    return in;
}

Eigen::Isometry3d poseOf3x4(const std::vector<double>& numbers, std::size_t first,
                            const std::string& where) {
    using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
    const Rows m = Eigen::Map<const Rows>(numbers.data() + first);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.leftCols<3>(),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
    if (R.determinant() < 0 || (R - m.leftCols<3>()).cwiseAbs().maxCoeff() > 1e-2)
        throw Error(where + ": the 3x3 part of the pose is not a rotation");
    return isometry(R, m.col(3));
}

void appendTum(Trajectory& trajectory, const std::vector<double>& numbers,
               const std::string& where) {
    if (!trajectory.stamps_s.empty() && numbers[0] <= trajectory.stamps_s.back())
        throw Error(where + (numbers[0] < trajectory.stamps_s.back()
                                 ? ": stamps must increase; sort the file by time"
                                 : ": duplicate stamp; remove one of the poses"));
    const Eigen::Quaterniond q(numbers[7], numbers[4], numbers[5], numbers[6]);
    if (std::abs(q.norm() - 1) > 1e-2) throw Error(where + ": the quaternion is not of length 1");
    trajectory.stamps_s.push_back(numbers[0]);
    trajectory.poses.push_back(
        isometry(q.normalized().toRotationMatrix(), {numbers[1], numbers[2], numbers[3]}));
}

std::string rowOf(const std::vector<double>& numbers) {
    std::string row;
    for (const double number : numbers) row += digitsOf(number) + ' ';
    row.back() = '\n';
    return row;
}
Trajectory trajectoryOf(std::istream& in, const std::string& path) {
    Trajectory trajectory;
    std::size_t columns = 0;
    forEachLine(in, path, [&](const std::vector<double>& numbers, const std::string& where) {
        if (columns == 0) columns = numbers.size();
        if (numbers.size() != columns || (columns != 12 && columns != 8))
            throw Error(where + ": " + std::to_string(numbers.size()) +
                        " numbers; a KITTI pose has 12, a TUM pose 8");
        if (columns == 12)
            trajectory.poses.push_back(poseOf3x4(numbers, 0, where));
        else
            appendTum(trajectory, numbers, where);
    });
    return trajectory;
}

Calibration calibrationOf(std::istream& in, const std::string& path) {
    Calibration calibration;
    std::string text;
    for (std::size_t line = 1; std::getline(in, text); ++line) {
        const std::string where = at(path, line);
        // KITTI odometry writes `Tr:`, its development kit `Tr_velo_to_cam:`.
        const auto colon = text.find(':');
        const std::string key = text.substr(0, colon);
        if (colon == std::string::npos || (key != "Tr" && key != "Tr_velo_to_cam")) continue;
        const auto numbers = numbersOf(text.substr(colon + 1), where);
        if (numbers.size() != 12) throw Error(where + ": Tr needs 12 numbers");
        calibration.Tr = poseOf3x4(numbers, 0, where);
        calibration.hasTr = true;
    }
    return calibration;
}
}  // namespace

Trajectory readTrajectory(const std::string& path) {
    auto in = opened(path);
    return trajectoryOf(in, path);
}

Trajectory trajectoryIn(const std::string& text, const std::string& name) {
    std::istringstream in(text);
    return trajectoryOf(in, name);
}

std::string kittiRow(const Eigen::Isometry3d& pose) {
    std::vector<double> numbers;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) numbers.push_back(pose(i, j));
    return rowOf(numbers);
}

void writeKitti(const Trajectory& trajectory, const std::string& path) {
    replaceTextFile(path, [&](std::ostream& out) {
        for (const auto& pose : trajectory.poses) out << kittiRow(pose);
    });
}

std::string tumRow(double stamp_s, const Eigen::Isometry3d& pose) {
    const Eigen::Vector3d at = pose.translation();
    Eigen::Quaterniond q(pose.linear());
    if (q.w() < 0) q.coeffs() *= -1;  // the same rotation, of which this is the usual form
    return rowOf({stamp_s, at.x(), at.y(), at.z(), q.x(), q.y(), q.z(), q.w()});
}

void writeTum(const Trajectory& trajectory, const std::string& path) {
    if (trajectory.stamps_s.size() != trajectory.poses.size())
        throw Error("cannot write '" + path + "': the trajectory has no time for every pose");
    replaceTextFile(path, [&](std::ostream& out) {
        for (std::size_t i = 0; i < trajectory.poses.size(); ++i)
            out << tumRow(trajectory.stamps_s[i], trajectory.poses[i]);
    });
}

std::vector<double> readTimes(const std::string& path) {
    std::vector<double> times;
    auto in = opened(path);
    forEachLine(in, path, [&](const std::vector<double>& numbers, const std::string& where) {
        if (numbers.size() != 1) throw Error(where + ": expected one time in seconds");
        times.push_back(numbers[0]);
    });
    return times;
}

Calibration readCalibration(const std::string& path) {
    auto in = opened(path);
    return calibrationOf(in, path);
}

Calibration calibrationIn(const std::string& text, const std::string& name) {
    std::istringstream in(text);
    return calibrationOf(in, name);
}

Trajectory lidarToCam0(const Trajectory& lidar, const Eigen::Isometry3d& Tr) {
    Trajectory cam0 = lidar;
    for (auto& pose : cam0.poses) pose = Tr * pose * Tr.inverse();
    return cam0;
}
}  // namespace delio::io
