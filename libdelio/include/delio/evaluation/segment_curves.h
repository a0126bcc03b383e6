#pragma once
#include <vector>

#include "delio/evaluation/comparison.h"

namespace delio::evaluation {
/** Mean errors of the segments of about one length, or one speed. */
struct CurvePoint {
    double at = 0;              //!< length in metres, or speed in km/h
    double t_percent = 0;       //!< translation error per length, in percent
    double r_deg_per_100m = 0;  //!< rotation error per length, in deg per 100 m
};

/** Errors over the length of the segments, as KITTI's development kit plots them: all segments of
 *  all of the estimate's sequences, and no point where fewer than three segments are. */
std::vector<CurvePoint> errorOverLength(const std::vector<const Comparison*>& sequences);

/** Errors over the mean speed of the segments: the kit's points are 2, 4, 6 ... m/s, each with the
 *  segments that are less than 2 m/s off it (so neighbours share segments). The kit ends at 24 m/s;
 *  here the points go on to the fastest segment. */
std::vector<CurvePoint> errorOverSpeed(const std::vector<const Comparison*>& sequences);
}  // namespace delio::evaluation
