#pragma once
#include <Eigen/Geometry>
#include <string>

namespace delio::earth {
/** A place on the earth (WGS84). */
struct Geodetic {
    double latitude_deg = 0;   //!< north positive
    double longitude_deg = 0;  //!< east positive
    double height_m = 0;       //!< above the ellipsoid
};

/** Latitude within 90 degrees, longitude within 360, height within 100 km, all finite. */
bool isPlausible(const Geodetic& place);

/** Earth-centred, earth-fixed coordinates (ECEF), metres. */
Eigen::Vector3d ecefOf(const Geodetic& place);

/** The inverse of ecefOf(). */
Geodetic geodeticOf(const Eigen::Vector3d& ecef);

/** East, north and up at a place: the tangent plane of the ellipsoid. */
class EnuFrame {
 public:
    /** The frame at `origin`. */
    explicit EnuFrame(const Geodetic& origin);

    const Geodetic& origin() const { return origin_; }  //!< of east, north and up
    /** Maps east, north, up to ECEF, metres. */
    const Eigen::Isometry3d& ecefFromEnu() const { return ecefFromEnu_; }

    Eigen::Vector3d enuOf(const Geodetic& place) const;     //!< metres
    Geodetic geodeticOf(const Eigen::Vector3d& enu) const;  //!< the inverse of enuOf()

 private:
    Geodetic origin_;
    Eigen::Isometry3d ecefFromEnu_;
};

/** A zone of the Universal Transverse Mercator system. */
struct UtmZone {
    int number = 31;    //!< 1 to 60
    bool north = true;  //!< false: southern hemisphere, with a false northing of 10 000 km
    /** EPSG code of "WGS 84 / UTM zone ...". */
    int epsg() const { return (north ? 32600 : 32700) + number; }
    /** Number and hemisphere: "32N". */
    std::string name() const { return std::to_string(number) + (north ? "N" : "S"); }
    /** The same number and hemisphere. */
    bool operator==(const UtmZone& other) const {
        return number == other.number && north == other.north;
    }
};

/** The zone that a place lies in, with the exceptions of Norway and Svalbard. */
UtmZone utmZoneOf(const Geodetic& place);

/** Easting, northing (metres) and height above the ellipsoid of a place, in that zone, which it
 *  may lie outside of by some degrees. Exact to 0.1 mm within 3000 km of the zone's meridian
 *  (Krueger's series; mrpt::topography::GeodeticToUTM is off by centimetres). */
Eigen::Vector3d utmOf(const Geodetic& place, const UtmZone& zone);

/** The inverse of utmOf(). */
Geodetic geodeticOfUtm(const Eigen::Vector3d& utm, const UtmZone& zone);

/** Angle from true north to grid north, degrees, clockwise positive. */
double convergence_deg(const Geodetic& place, const UtmZone& zone);

/** The coordinate system as OGC WKT 1: UTM with ellipsoidal heights, as LAS 1.4 wants it. */
std::string wktOf(const UtmZone& zone);

/** Reads the zone of a WKT that names "UTM zone 32N"; false where it names none. */
bool zoneIn(const std::string& wkt, UtmZone& zone);
}  // namespace delio::earth
