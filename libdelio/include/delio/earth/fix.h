#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "delio/earth/coordinates.h"

namespace delio::earth {
/** A position of a GNSS antenna. */
struct Fix {
    double stamp_s = 0;  //!< of the drive, as Scan::stamp_s
    Geodetic place;      //!< of the antenna
    /** Of the place, east, north, up, m^2. */
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    /** The antenna in the vehicle's frame, metres (lever arm); nothing: not known. */
    std::optional<Eigen::Vector3d> antenna;
};
using Fixes = std::vector<Fix>;

/** Covariance (m^2) of a fix of this quality, as NMEA's GGA numbers them: 1 GPS (3 m times HDOP),
 *  2 differential (1 m), 3 PPS, 4 RTK fixed (2 cm), 5 RTK float (0.3 m), others as 1; the height
 *  is twice as uncertain. `hdop`: horizontal dilution of precision, 0 if unknown (taken as 1). */
Eigen::Matrix3d covarianceOf(int quality, double hdop);

/** A place other than latitude 0, longitude 0, finite, with a finite and positive covariance. */
bool isUsable(const Fix& fix);
}  // namespace delio::earth
