#pragma once
#include <Eigen/Geometry>

#include "delio/points/point_map.h"
#include "delio/surfaces/normals.h"

namespace delio {
/** A direction of the map's frame along which a scan may stand still. */
struct StandstillTest {
    Eigen::Vector3d axis;     //!< unit vector
    bool isVertical = false;  //!< nothing that the sensor sees moves along it together with it
    double probe = 0;         //!< metres: so far along the axis the scan must no longer fit
    double reach = 0;         //!< metres: surfaces and points of the map may be so far apart
};

/** True where the scan shows that the sensor did not move along the axis, away from `pose` (sensor
 *  to map), where the map was seen before. Rings on the ground and on smooth walls lie on earlier
 *  ones wherever the sensor is. So only surfaces that face the axis count. They have to lie on the
 *  map's points here, but not `probe` to either side; and to more than one side of the sensor,
 *  unlike a vehicle that drives ahead. `scan`: static surfaces, sensor's frame. */
bool showsStandstill(const points::PointMap& map, const surfaces::SurfaceNormals& scan,
                     const Eigen::Isometry3d& pose, const StandstillTest& test);
}  // namespace delio
