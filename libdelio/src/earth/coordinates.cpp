#include "delio/earth/coordinates.h"

#include <array>
#include <cmath>
#include <complex>

#include "delio/core/text.h"

namespace delio::earth {
using Eigen::Vector3d;

namespace {
constexpr double kDeg = M_PI / 180;
// WGS84: half axis (m) and flattening.
constexpr double kA = 6378137, kF = 1 / 298.257223563;
constexpr double kE2 = kF * (2 - kF);  // eccentricity squared
constexpr double kScale = 0.9996, kFalseEasting = 500000, kFalseNorthing = 10000000;

// Krueger's series to the sixth order in the third flattening (Karney, 2011).
constexpr double kN = kF / (2 - kF);
constexpr double power(double base, int exponent) {
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
}
constexpr double n2 = power(kN, 2), n3 = power(kN, 3), n4 = power(kN, 4), n5 = power(kN, 5),
                 n6 = power(kN, 6);
constexpr double kMeridian = kA / (1 + kN) * (1 + n2 / 4 + n4 / 64 + n6 / 256);
constexpr std::array<double, 6> kAlpha{
    kN / 2 - n2 * 2 / 3 + n3 * 5 / 16 + n4 * 41 / 180 - n5 * 127 / 288 + n6 * 7891 / 37800,
    n2 * 13 / 48 - n3 * 3 / 5 + n4 * 557 / 1440 + n5 * 281 / 630 - n6 * 1983433 / 1935360,
    n3 * 61 / 240 - n4 * 103 / 140 + n5 * 15061 / 26880 + n6 * 167603 / 181440,
    n4 * 49561 / 161280 - n5 * 179 / 168 + n6 * 6601661 / 7257600,
    n5 * 34729 / 80640 - n6 * 3418889 / 1995840,
    n6 * 212378941 / 319334400};
constexpr std::array<double, 6> kBeta{
    kN / 2 - n2 * 2 / 3 + n3 * 37 / 96 - n4 / 360 - n5 * 81 / 512 + n6 * 96199 / 604800,
    n2 / 48 + n3 / 15 - n4 * 437 / 1440 + n5 * 46 / 105 - n6 * 1118711 / 3870720,
    n3 * 17 / 480 - n4 * 37 / 840 - n5 * 209 / 4480 + n6 * 5569 / 90720,
    n4 * 4397 / 161280 - n5 * 11 / 504 - n6 * 830251 / 7257600,
    n5 * 4583 / 161280 - n6 * 108847 / 3991680,
    n6 * 20648693 / 638668800};

double meridianOf(const UtmZone& zone) { return 6.0 * zone.number - 183; }

/** Longitude from a zone's meridian, degrees in (-180, 180]. */
double fromMeridian(double longitude_deg, const UtmZone& zone) {
    return std::remainder(longitude_deg - meridianOf(zone), 360);
}

/** Tangent of the conformal latitude of one whose tangent is `t`. */
double conformal(double t) {
    const double e = std::sqrt(kE2);
    const double sigma = std::sinh(e * std::atanh(e * t / std::sqrt(1 + t * t)));
    return t * std::sqrt(1 + sigma * sigma) - sigma * std::sqrt(1 + t * t);
}

/** The inverse of conformal(), by Newton's method. */
double latitudeTangent(double conformalTangent) {
    double t = conformalTangent / (1 - kE2);
    for (int i = 0; i < 6; ++i) {
        const double now = conformal(t);
        t += (conformalTangent - now) / std::sqrt(1 + now * now) * (1 + (1 - kE2) * t * t) /
             ((1 - kE2) * std::sqrt(1 + t * t));
    }
    return t;
}
}  // namespace

bool isPlausible(const Geodetic& place) {
    constexpr double kHighest_m = 1e5;
    return std::abs(place.latitude_deg) <= 90 && std::abs(place.longitude_deg) <= 360 &&
           std::abs(place.height_m) <= kHighest_m;
}

Vector3d ecefOf(const Geodetic& place) {
    const double lat = place.latitude_deg * kDeg, lon = place.longitude_deg * kDeg;
    const double radius = kA / std::sqrt(1 - kE2 * std::sin(lat) * std::sin(lat));
    const double level = (radius + place.height_m) * std::cos(lat);
    return {level * std::cos(lon), level * std::sin(lon),
            ((1 - kE2) * radius + place.height_m) * std::sin(lat)};
}

Geodetic geodeticOf(const Vector3d& ecef) {
    const double level = ecef.head<2>().norm();
    double lat = std::atan2(ecef.z(), level * (1 - kE2)), radius = kA;
    for (int i = 0; i < 10; ++i) {  // three are enough near the ground
        radius = kA / std::sqrt(1 - kE2 * std::sin(lat) * std::sin(lat));
        lat = std::atan2(ecef.z() + kE2 * radius * std::sin(lat), level);
    }
    // Good at every latitude: the distance along the normal of the ellipsoid.
    const double height = level * std::cos(lat) + ecef.z() * std::sin(lat) -
                          radius * (1 - kE2 * std::sin(lat) * std::sin(lat));
    return {lat / kDeg, std::atan2(ecef.y(), ecef.x()) / kDeg, height};
}

EnuFrame::EnuFrame(const Geodetic& origin) : origin_(origin) {
    const double lat = origin.latitude_deg * kDeg, lon = origin.longitude_deg * kDeg;
    ecefFromEnu_ = Eigen::Isometry3d::Identity();
    ecefFromEnu_.linear().col(0) = Vector3d(-std::sin(lon), std::cos(lon), 0);
    ecefFromEnu_.linear().col(2) =
        Vector3d(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat));
    ecefFromEnu_.linear().col(1) = ecefFromEnu_.linear().col(2).cross(ecefFromEnu_.linear().col(0));
    ecefFromEnu_.translation() = ecefOf(origin);
}

Vector3d EnuFrame::enuOf(const Geodetic& place) const {
    return ecefFromEnu_.linear().transpose() * (ecefOf(place) - ecefFromEnu_.translation());
}

Geodetic EnuFrame::geodeticOf(const Vector3d& enu) const {
    return earth::geodeticOf(Vector3d(ecefFromEnu_ * enu));
}

UtmZone utmZoneOf(const Geodetic& place) {
    const double lon = std::remainder(place.longitude_deg, 360), lat = place.latitude_deg;
    UtmZone zone;
    zone.north = lat >= 0;
    zone.number = std::min(60, static_cast<int>(std::floor((lon + 180) / 6)) + 1);
    if (lat >= 56 && lat < 64 && lon >= 3 && lon < 12) zone.number = 32;  // Norway
    if (lat >= 72 && lat < 84 && lon >= 0 && lon < 42)                    // Svalbard
        zone.number = lon < 9 ? 31 : lon < 21 ? 33 : lon < 33 ? 35 : 37;
    return zone;
}

Vector3d utmOf(const Geodetic& place, const UtmZone& zone) {
    const double lon = fromMeridian(place.longitude_deg, zone) * kDeg;
    const double t = conformal(std::tan(place.latitude_deg * kDeg));
    const std::complex<double> zeta(std::atan2(t, std::cos(lon)),
                                    std::asinh(std::sin(lon) / std::hypot(t, std::cos(lon))));
    std::complex<double> sum = zeta;
    for (std::size_t i = 0; i < kAlpha.size(); ++i)
        sum += kAlpha[i] * std::sin(2.0 * static_cast<double>(i + 1) * zeta);
    return {kFalseEasting + kScale * kMeridian * sum.imag(),
            (zone.north ? 0 : kFalseNorthing) + kScale * kMeridian * sum.real(), place.height_m};
}

Geodetic geodeticOfUtm(const Vector3d& utm, const UtmZone& zone) {
    const std::complex<double> sum(
        (utm.y() - (zone.north ? 0 : kFalseNorthing)) / (kScale * kMeridian),
        (utm.x() - kFalseEasting) / (kScale * kMeridian));
    std::complex<double> zeta = sum;
    for (std::size_t i = 0; i < kBeta.size(); ++i)
        zeta -= kBeta[i] * std::sin(2.0 * static_cast<double>(i + 1) * sum);
    const double across = std::sinh(zeta.imag()), along = std::cos(zeta.real());
    const double lon = std::atan2(across, along);
    const double t = latitudeTangent(std::sin(zeta.real()) / std::hypot(across, along));
    return {std::atan(t) / kDeg, std::remainder(lon / kDeg + meridianOf(zone), 360), utm.z()};
}

double convergence_deg(const Geodetic& place, const UtmZone& zone) {
    // Of two places a hundred metres apart along the meridian.
    constexpr double kStep_deg = 0.0005;
    Geodetic south = place, north = place;
    south.latitude_deg -= kStep_deg;
    north.latitude_deg += kStep_deg;
    const Vector3d way = utmOf(north, zone) - utmOf(south, zone);
    return -std::atan2(way.x(), way.y()) / kDeg;
}

std::string wktOf(const UtmZone& zone) {
    const std::string name = "WGS 84 / UTM zone " + zone.name();
    return "COMPD_CS[\"" + name + " + ellipsoidal height\",PROJCS[\"" + name +
           "\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563,"
           "AUTHORITY[\"EPSG\",\"7030\"]],AUTHORITY[\"EPSG\",\"6326\"]],PRIMEM[\"Greenwich\",0,"
           "AUTHORITY[\"EPSG\",\"8901\"]],UNIT[\"degree\",0.0174532925199433,"
           "AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]],"
           "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],"
           "PARAMETER[\"central_meridian\"," +
           std::to_string(6 * zone.number - 183) +
           "],PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],"
           "PARAMETER[\"false_northing\"," +
           (zone.north ? "0" : "10000000") +
           "],UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],AXIS[\"Easting\",EAST],"
           "AXIS[\"Northing\",NORTH],AUTHORITY[\"EPSG\",\"" +
           std::to_string(zone.epsg()) +
           "\"]],VERT_CS[\"WGS 84 ellipsoidal height\",VERT_DATUM[\"Ellipsoid\",2002],"
           "UNIT[\"metre\",1,AUTHORITY[\"EPSG\",\"9001\"]],AXIS[\"Up\",UP]]]";
}

bool zoneIn(const std::string& wkt, UtmZone& zone) {
    const std::string words = "UTM zone ";
    const auto at = wkt.find(words);
    if (at == wkt.npos) return false;
    const auto end = wkt.find_first_not_of("0123456789", at + words.size());
    if (end == wkt.npos || (wkt[end] != 'N' && wkt[end] != 'S')) return false;
    const auto number =
        numberIn<int>(std::string_view(wkt).substr(at + words.size(), end - at - words.size()));
    if (!number || *number < 1 || *number > 60) return false;
    zone = {*number, wkt[end] == 'N'};
    return true;
}
}  // namespace delio::earth
