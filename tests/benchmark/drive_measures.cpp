#include "drive_measures.h"

#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/voxel_grid.h"
#include "odometry/rings.h"

namespace delio::benchmark {
namespace {
constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kSensorHeight_m = 1.73;

Eigen::Matrix3Xd pointsOf(const Scan& scan) {
    const auto& map = *scan.points;
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(map.size()));
    for (std::size_t i = 0; i < map.size(); ++i)
        points.col(static_cast<Eigen::Index>(i)) << map.getPointsBufferRef_x()[i],
            map.getPointsBufferRef_y()[i], map.getPointsBufferRef_z()[i];
    return points;
}

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return std::nan("");
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
}

std::string text(const char* format, double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof(buffer), format, value);
    return buffer;
}

std::string percent(std::size_t part, std::size_t whole) {
    return text("%.2f", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

std::string quartiles(const std::vector<double>& values, const char* format) {
    return text(format, percentile(values, 0.25)) + " / " + text(format, percentile(values, 0.5)) +
           " / " + text(format, percentile(values, 0.75));
}

double azimuth_deg(const Eigen::Vector3d& p) { return std::atan2(p.y(), p.x()) / kDegree; }

mrpt::maps::CSimplePointsMap mapOf(const Eigen::Matrix3Xf& points) {
    mrpt::maps::CSimplePointsMap map;
    for (const auto& p : points.colwise()) map.insertPointFast(p.x(), p.y(), p.z());
    map.mark_as_modified();
    return map;
}
}  // namespace

void DriveMeasures::add(const Scan& scan) {
    const Eigen::Matrix3Xd points = pointsOf(scan);
    ++scans_;
    points_ += static_cast<std::size_t>(points.cols());
    addRanges(points);
    addGround(points);
    addPlanarity(points);
    addRings(points);
    addIntensity(scan, points);
}

void DriveMeasures::addRanges(const Eigen::Matrix3Xd& points) {
    for (const auto& p : points.colwise())
        for (std::size_t bin = 0; bin < ranges_.size(); ++bin)
            if (p.norm() < kRangeEdges_m[bin + 1]) {
                ++ranges_[bin];
                break;
            }
}

/** DenseSubmap: within 0.15 m of the lowest points (5 %) of its square metre, where those lie about
 * as deep as the road. */
void DriveMeasures::addGround(const Eigen::Matrix3Xd& points) {
    std::map<std::pair<long, long>, Samples> cells;
    for (const auto& p : points.colwise())
        cells[{std::lround(p.x()), std::lround(p.y())}].push_back(p.z());
    for (const auto& [cell, heights] : cells) {
        const double low = percentile(heights, 0.05);
        const double away =
            std::hypot(static_cast<double>(cell.first), static_cast<double>(cell.second));
        if (std::abs(low + kSensorHeight_m) > 0.4 + 0.04 * away) continue;
        for (const double z : heights) ground_ += z < low + 0.15 ? 1 : 0;
    }
}

/** Of 15 neighbours in space within 30 m, thinned to one point in 0.3 m. */
void DriveMeasures::addPlanarity(const Eigen::Matrix3Xd& points) {
    constexpr std::size_t kNeighbours = 15;
    const Eigen::Matrix3Xf thin = voxelCentroids(points.cast<float>(), 0.3);
    const auto map = mapOf(thin);
    for (Eigen::Index i = 0; i < thin.cols(); i += 5) {
        if (thin.col(i).norm() > 30) continue;
        std::vector<std::size_t> indices;
        std::vector<float> distances;
        map.kdTreeNClosestPoint3DIdx(thin(0, i), thin(1, i), thin(2, i), kNeighbours, indices,
                                     distances);
        Eigen::Matrix3Xd around(3, static_cast<Eigen::Index>(indices.size()));
        for (std::size_t k = 0; k < indices.size(); ++k)
            around.col(static_cast<Eigen::Index>(k)) =
                thin.col(static_cast<Eigen::Index>(indices[k])).cast<double>();
        around.colwise() -= around.rowwise().mean().eval();
        const Eigen::Vector3d l =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(around * around.transpose())
                .eigenvalues();
        if (l[1] > 0) flatness_.push_back(l[0] / l[1]);
    }
}

void DriveMeasures::addRings(const Eigen::Matrix3Xd& points) {
    const Eigen::Matrix3Xf asFloat = points.cast<float>();
    const auto numbers = odometry::ringsOf(asFloat);
    std::map<int, std::vector<Eigen::Index>> rings;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        rings[numbers[i]].push_back(static_cast<Eigen::Index>(i));
    for (const auto& [number, ring] : rings) {
        Samples elevations;
        for (const auto i : ring)
            elevations.push_back(std::asin(points(2, i) / points.col(i).norm()) / kDegree);
        const auto count = static_cast<double>(ring.size());
        perRing_.push_back(count);
        (percentile(elevations, 0.5) > -8.6 ? upper_ : lower_).push_back(count);
        addRing(points, ring);
    }
}

/** What shows along one ring: noise, lost firings, points in mid-air. */
void DriveMeasures::addRing(const Eigen::Matrix3Xd& points, const std::vector<Eigen::Index>& ring) {
    constexpr double kColumn_deg = 360.0 / 2083;  // of an HDL-64E at 10 Hz
    for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
        const Eigen::Vector3d a = points.col(ring[k - 1]), b = points.col(ring[k]),
                              c = points.col(ring[k + 1]);
        const double before = std::remainder(azimuth_deg(b) - azimuth_deg(a), 360);
        const double after = std::remainder(azimuth_deg(c) - azimuth_deg(b), 360);
        ++inRings_;
        const double ra = a.norm(), rb = b.norm(), rc = c.norm();
        const bool adjacent =
            before > 0 && after > 0 && before < 1.5 * kColumn_deg && after < 1.5 * kColumn_deg;
        if (adjacent) {
            step_.push_back(before);
            if (std::abs(rb - ra) < 0.15 && std::abs(rc - rb) < 0.15 && rb < 30)
                bend_.push_back(std::abs(ra - 2 * rb + rc) / std::sqrt(6.0));
            if ((ra - rb) * (rb - rc) > 0 && std::min(std::abs(ra - rb), std::abs(rb - rc)) > 0.3)
                ++between_;
            if ((ra - rb) * (rb - rc) < 0 && std::min(std::abs(ra - rb), std::abs(rb - rc)) > 0.3)
                ++spikes_;
        }
        // Lost firings, where the surface goes on beyond the gap.
        if (before <= 0 || std::abs(rb - ra) > 0.3 + 0.02 * rb) continue;
        const double lost = before / kColumn_deg - 1;
        ++steps_;
        if (lost > 0.5 && lost <= 1.5) ++gaps1_;
        if (lost > 1.5 && lost <= 4.5) ++gaps2_;
        if (lost > 4.5 && lost < 60) ++gaps5_;
    }
}

void DriveMeasures::addIntensity(const Scan& scan, const Eigen::Matrix3Xd& points) {
    const auto* map = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(scan.points.get());
    if (!map) return;
    for (Eigen::Index i = 0; i < points.cols(); i += 7)
        for (std::size_t bin = 0; bin < intensity_.size(); ++bin)
            if (points.col(i).norm() < kRangeEdges_m[bin + 1]) {
                intensity_[bin].push_back(
                    static_cast<double>(map->getPointIntensity(static_cast<std::size_t>(i))));
                break;
            }
}

void DriveMeasures::addPair(const Scan& earlier, const Scan& later,
                            const Eigen::Isometry3d& motion) {
    const auto map = mapOf(pointsOf(earlier).cast<float>());
    const Eigen::Matrix3Xd points = pointsOf(later);
    for (Eigen::Index i = 0; i < points.cols(); i += 23) {
        const double range = points.col(i).norm();
        if (range < 3 || range > 30) continue;
        const Eigen::Vector3f p = (motion * points.col(i).eval()).cast<float>();
        float squared = 0;
        map.kdTreeClosestPoint3D(p.x(), p.y(), p.z(), squared);
        coincidence_.push_back(std::sqrt(static_cast<double>(squared)));
    }
}

std::vector<std::pair<std::string, std::string>> DriveMeasures::rows() const {
    std::vector<std::pair<std::string, std::string>> rows;
    const auto add = [&](const std::string& name, const std::string& value) {
        rows.emplace_back(name, value);
    };
    add("scans measured", std::to_string(scans_));
    add("points per scan",
        text("%.0f", static_cast<double>(points_) / static_cast<double>(scans_)));
    add("ground, % of points", percent(ground_, points_));
    const char* const bins[] = {"0-5", "5-10", "10-20", "20-40", "40-80", "80-"};
    for (std::size_t bin = 0; bin < ranges_.size(); ++bin)
        add(std::string("range ") + bins[bin] + " m, % of points", percent(ranges_[bin], points_));
    add("l0/l1 of 15 neighbours, 25/50/75 %", quartiles(flatness_, "%.4f"));
    add("points per ring above -8.6 deg, mean", text("%.0f", mean(upper_)));
    add("points per ring below, mean", text("%.0f", mean(lower_)));
    add("points per ring, 10/90 %",
        text("%.0f", percentile(perRing_, 0.1)) + " / " + text("%.0f", percentile(perRing_, 0.9)));
    add("noise along a ring, m, 25/50/75 %", quartiles(bend_, "%.4f"));
    add("azimuth step, deg, 25/50/75 %", quartiles(step_, "%.4f"));
    add("gaps of 1 firing, % of steps", percent(gaps1_, steps_));
    add("gaps of 2-4 firings, %", percent(gaps2_, steps_));
    add("gaps of 5-60 firings, %", percent(gaps5_, steps_));
    add("points between two surfaces, %", percent(between_, inRings_));
    add("points out of their surface, %", percent(spikes_, inRings_));
    for (std::size_t bin = 0; bin < ranges_.size(); ++bin)
        add(std::string("intensity ") + bins[bin] + " m, 25/50/75 %",
            quartiles(intensity_[bin], "%.2f"));
    add("nearest in the scan before, m, 50/90 %", text("%.4f", percentile(coincidence_, 0.5)) +
                                                      " / " +
                                                      text("%.4f", percentile(coincidence_, 0.9)));
    return rows;
}
}  // namespace delio::benchmark
