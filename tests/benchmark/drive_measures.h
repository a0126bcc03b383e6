#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "delio/odometry/scan.h"

namespace delio::benchmark {
/** What can be counted in scans of a spinning LiDAR to tell real ones from made-up ones. Lengths in
 *  metres, angles in degrees; the sensor stands 1.73 m above the ground. */
class DriveMeasures {
 public:
    /** Adds the measures of one scan. */
    void add(const Scan& scan);
    /** Adds how well two consecutive scans coincide; `motion` maps `later` to `earlier`. */
    void addPair(const Scan& earlier, const Scan& later, const Eigen::Isometry3d& motion);

    /** Name and value of each measure. */
    std::vector<std::pair<std::string, std::string>> rows() const;

 private:
    using Samples = std::vector<double>;
    void addRanges(const Eigen::Matrix3Xd& points);
    void addGround(const Eigen::Matrix3Xd& points);
    void addPlanarity(const Eigen::Matrix3Xd& points);
    void addRings(const Eigen::Matrix3Xd& points);
    void addRing(const Eigen::Matrix3Xd& points, const std::vector<Eigen::Index>& ring);
    void addIntensity(const Scan& scan, const Eigen::Matrix3Xd& points);

    static constexpr std::array<double, 7> kRangeEdges_m = {0, 5, 10, 20, 40, 80, 1e9};
    std::size_t scans_ = 0, points_ = 0, ground_ = 0;
    std::array<std::size_t, 6> ranges_{};
    Samples flatness_;                 // l0 / l1 of neighbourhoods
    Samples upper_, lower_, perRing_;  // points in a ring
    Samples bend_;                     // of range along a ring on smooth surfaces
    Samples step_;                     // of azimuth
    std::size_t steps_ = 0, gaps1_ = 0, gaps2_ = 0, gaps5_ = 0;
    std::size_t inRings_ = 0, between_ = 0, spikes_ = 0;
    std::array<Samples, 6> intensity_;
    Samples coincidence_;
};
}  // namespace delio::benchmark
