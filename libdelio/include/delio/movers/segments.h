#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "delio/core/stage_options.h"

namespace delio::movers {
/** Which points are one segment. */
struct SegmentOptions : public StageOptions {
    double cell = 0.4;
    double radius = 60;
    double above_ground = 0.3;
    double height = 2.8;
    double max_length = 12;
    unsigned min_points = 5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Points that stand together on the ground, apart from others. */
struct Segment {
    std::vector<Eigen::Index> points;  //!< which
    Eigen::AlignedBox3f box;           //!< metres, the points' frame
};

/** What stands on the ground about a vehicle, in pieces: points (metres, a frame with z up) higher
 *  above the lowest ones about them than `above_ground`, connected over cells of the ground plane
 *  that touch. What is longer than `max_length` (walls, hedges) or has fewer than `min_points` is
 *  left out. */
std::vector<Segment> segmentsOf(const Eigen::Matrix3Xf& points, const SegmentOptions& options);
}  // namespace delio::movers
