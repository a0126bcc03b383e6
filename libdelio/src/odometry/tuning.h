#pragma once
#include <cmath>

#include "delio/core/odometry_options.h"

/** Numbers that decide how the odometry works and that no profile sets: they are no options.
 *  Metres, seconds and radians unless a name says otherwise. */
namespace delio::odometry {
/** Spacings and limits of PlaneOdometry. All but the acceleration are for streets and scale with
 *  the place. */
struct SpacingTuning {
    double map_spacing = 0.25;      //!< points of a scan that enter the map
    double scan_spacing = 0.5;      //!< points that are registered to planes
    double point_spacing = 1.0;     //!< points that are registered to points
    double doubt_spacing = 10;      //!< degenerate scans enter the map once in such a distance
    double first_speed = 40;        //!< m/s; an unknown motion is searched up to this speed
    double acceleration = 15;       //!< m/s^2; of the hardest start or stop, between two scans
    double braking = 10;            //!< m/s^2; of the hardest stop that takes seconds
    double pause_acceleration = 2;  //!< m/s^2; the same, over more than half a second
    double first_turn_radps = 60 * M_PI / 180;  //!< an unknown motion is searched up to this rate
    double most_turn_rad = 30 * M_PI / 180;     //!< and up to this turn; does not scale
};

/** How points and planes are weighed against each other (LocalMap). */
struct LocalMapTuning {
    double point_sigma = 0.05;     //!< error of a registration to points along each axis
    double point_sigma_deg = 1.0;  //!< the same about each axis but the spin axis
    double max_deviation = 0.1;    //!< planes that lead farther from the points' pose are rejected
    double max_deviation_deg = 3.0;  //!< the same of the rotation
    /** Points see an axis if they bring the scan back that was moved along it by this. Scales with
     *  the place. */
    double probe = 0.5;
};

/** Inlier ratios that differ by less are equally good. */
constexpr double kInlierNoise = 0.02;

/** Which points are one segment. */
struct SegmentTuning {
    double cell = 0.4;          //!< of the ground plane; points in cells that touch are connected
    double radius = 60;         //!< of the area about the sensor
    double above_ground = 0.3;  //!< so much above the lowest points about it a point stands
    double height = 2.8;        //!< points higher above the ground are left out
    double max_length = 12;     //!< longer is a wall or a hedge
    unsigned min_points = 5;    //!< fewer are no segment
};

/** Registration to planes. */
namespace plane_tuning {
constexpr double kPointSigma_m = 0.01;      //!< noise of a point across its plane
constexpr double kConverged_rad = 2e-5;     //!< smaller rotation steps end the iteration
constexpr double kIndependentRatio = 0.16;  //!< neighbours err together: so many points count
constexpr double kSearchSpeed_mps = 40;     //!< an unknown motion is searched up to this speed
}  // namespace plane_tuning

/** Parts of the own vehicle. */
namespace own_vehicle_tuning {
constexpr double kVoxel_m = 0.25;       //!< places in the sensor's frame
constexpr double kReach_m = 10;         //!< a trailer's rear is not farther
constexpr double kLongest_m = 6;        //!< part
constexpr double kAboveGround_m = 0.4;  //!< the ground stays at one place, too
constexpr double kGroundShare = 0.05;   //!< of the near points, the lowest, are no higher than it
constexpr double kStep_m = 0.5;         //!< between two scans that are compared
constexpr unsigned kScans = 40;         //!< that are compared: over 20 m at least
constexpr double kAlways = 0.9;         //!< of the scans show a part of the own vehicle
constexpr double kOften = 0.3;          //!< of the scans show what it would be connected to
}  // namespace own_vehicle_tuning

/** Dynamic objects. */
namespace dynamic_tuning {
constexpr double kMargin_m = 0.4;       //!< a beam that went on by this saw the place free
constexpr double kInterval_s = 0.1;     //!< between the earlier scans that are compared
constexpr double kMemory_s = 0.8;       //!< age of the earliest of them
constexpr double kMinFreeRatio = 0.5;   //!< of a segment's points in known places, seen free
constexpr double kMinKnownRatio = 0.3;  //!< of its points, in places of which something is known
}  // namespace dynamic_tuning

/** The options of PlaneOdometry and its tuning, at the scale of a place. */
struct ScaledOptions : public PlaneOdometryOptions {
    SpacingTuning spacing;
    LocalMapTuning localMap;
};

/** All lengths that depend on the size of the place, which are given for streets, times `scale`. */
ScaledOptions atScale(const PlaneOdometryOptions& options, double scale);
}  // namespace delio::odometry
