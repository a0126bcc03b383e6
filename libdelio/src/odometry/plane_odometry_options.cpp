#include "delio/odometry/plane_odometry_options.h"

namespace delio {
std::vector<OptionField> PlaneTrackerOptions::fields() const {
    using Me = PlaneTrackerOptions;
    return {
        {"map_spacing", &Me::map_spacing,
         "m; points of a scan that go into the map are so far apart", 0.01, 10},
        {"scan_spacing", &Me::scan_spacing,
         "m; points that are registered against planes are so far apart", 0.01, 10},
        {"point_spacing", &Me::point_spacing,
         "m; points that are registered against points are so far apart", 0.01, 10},
        {"first_speed", &Me::first_speed,
         "m/s; a motion of which nothing is known is looked for up to this", 0, 1000},
        {"acceleration", &Me::acceleration, "m/s2; of the hardest start or stop", 0, 1000},
        {"doubt_spacing", &Me::doubt_spacing,
         "m; scans that are weakly observed go into the map in such steps, not each", 0, 1000},
        {"scale", &Me::scale,
         "size of the place, by which all lengths that depend on it are multiplied: 1 for "
         "streets, less for rooms; 0: from the scan",
         0, 1},
        {"lost_share", &Me::lost_share,
         "share of the usual share of points on those of the map; with less it is searched for by "
         "surfaces, too",
         0, 1}};
}
}  // namespace delio
