#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "delio/core/odometry_options.h"
#include "delio/odometry/scan.h"

namespace delio::odometry {
/** A scan as the stages want it. */
struct PointCloud {
    Eigen::Matrix3Xf points;             //!< metres, in the sensor's frame, in the sensor's order
    std::vector<std::uint16_t> rings;    //!< of each point, as its source numbers them, or empty
    std::vector<float> times_s;          //!< of each point from the scan's time; empty: all then
    double stamp_s = 0;                  //!< the stamp, from the scan's time
    std::vector<std::uint32_t> indices;  //!< of each point in the scan
    std::size_t notFinite = 0;   //!< points dropped because a coordinate was NaN or infinite
    std::size_t outOfRange = 0;  //!< points dropped by min_range and max_range
};

/** Drops points that are not finite or out of range, and raises every point's vertical angle by
 *  `vertical_correction_deg` (range kept): KITTI's HDL-64E needs 0.205 deg (IMLS-SLAM, KISS-ICP).
 */
PointCloud preprocess(const Scan& scan, const PreprocessOptions& options);

/** Makes the middle of the points' times the scan's time, which was the stamp: drivers stamp the
 *  begin of a turn, its end, or the arrival of the message. Without times it stays the stamp. */
void countFromMiddle(PointCloud& cloud);

/** The least and the greatest of the times, of which there is at least one. */
std::pair<float, float> rangeOf(const std::vector<float>& times_s);

/** Times of the first and the last point, from the scan's; both 0 without times. */
std::pair<double, double> endsOf(const PointCloud& cloud);

/** Why preprocess() leaves no point of a scan, in words; empty where it leaves some. */
std::string whyNoneIsLeft(const Scan& scan, const PreprocessOptions& options);

/** Ring of each point, from 0, neighbours with consecutive numbers: the source's, sorted from the
 *  top, or, where it has none, those of ringsOf(). `upright` turns the cloud's frame such that
 * the sensor spins about z. */
std::vector<std::uint16_t> neighbouringRings(
    const PointCloud& cloud, const Eigen::Matrix3f& upright = Eigen::Matrix3f::Identity());

}  // namespace delio::odometry
