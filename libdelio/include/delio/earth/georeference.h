#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "delio/core/increment.h"
#include "delio/earth/coordinates.h"

namespace delio::earth {
/** Where a map lies on the earth. */
struct Georeference {
    Geodetic origin;  //!< of east, north, up
    /** Maps the map's coordinates to east, north, up of the origin, metres. */
    Eigen::Isometry3d enuFromMap = Eigen::Isometry3d::Identity();
    /** Of `enuFromMap`, in the frame of the map (right tangent); 0: not known. */
    Matrix6 covariance = Matrix6::Zero();

    /** Gives the same place with the map's origin as that of east, north, up: via ECEF, exactly. */
    void moveOriginToMap();

    /** Direction of north in the map's frame; unit length. */
    Eigen::Vector3d north() const { return enuFromMap.linear().row(1).transpose(); }

    /** Latitude, longitude and height of a point of the map (metres). */
    Geodetic geodeticOf(const Eigen::Vector3d& inMap) const {
        return EnuFrame(origin).geodeticOf(enuFromMap * inMap);
    }
};

/** A known point on the ground (ground control point), and where the map has it. */
struct ControlPoint {
    std::string name;                                 //!< as the user writes it
    Eigen::Vector3d inMap = Eigen::Vector3d::Zero();  //!< metres
    Geodetic place;                                   //!< true place
    bool isUsed = false;  //!< it places the map; false: it is checked only
};

/** Places a map by its used points: rigid least squares. Throws Error where fewer than three are
 *  used, where they lie on one line, or where they contradict each other by more than a quarter of
 *  their extent. The covariance is that of the residuals; with three points it is a rough one. */
Georeference georeferenceOf(const std::vector<ControlPoint>& points);

/** From where the point is to where the map has it: east, north, up, metres. */
Eigen::Vector3d errorOf(const ControlPoint& point, const Georeference& place);

/** How a map was georeferenced by GNSS fixes. */
struct GnssFigures {
    std::size_t fixes = 0;        //!< read
    std::size_t used = 0;         //!< of these within the drive
    std::size_t rejected = 0;     //!< of the used ones: outliers
    std::size_t inGraph = 0;      //!< factors of the pose graph
    double rms_m = 0;             //!< distance of inliers from their places, horizontally
    double rmsUp_m = 0;           //!< the same in height
    double heading_deg = 0;       //!< of the map's x axis, clockwise from north
    double headingSigma_deg = 0;  //!< standard deviation of the heading of the whole track
    /** Standard deviations of the map's origin: east, north, up, metres. */
    Eigen::Vector3d originSigma_m = Eigen::Vector3d::Zero();
    std::string refusal;  //!< why the map is not georeferenced; empty: it is, or without fixes
};

/** Heading of the map's x axis, degrees clockwise from north. */
double heading_deg(const Eigen::Isometry3d& enuFromMap);

/** Maps coordinates of a georeferenced map to UTM less an offset, so that floats hold them. UTM
 *  stretches lengths by up to 1 in 1000: this is no rigid transformation. */
class MapToUtm {
 public:
    /** The zone is that of the origin, the offset its coordinates, rounded to kilometres. */
    explicit MapToUtm(const Georeference& place);

    const UtmZone& zone() const { return zone_; }  //!< of the output
    /** Of zero in the output: easting, northing, 0, metres. */
    const Eigen::Vector3d& offset() const { return offset_; }

    /** A point of the map (metres) in UTM, less the offset. */
    Eigen::Vector3d operator()(const Eigen::Vector3d& inMap) const;
    /** Turns directions and poses, by the convergence at the origin. */
    const Eigen::Matrix3d& rotation() const { return rotation_; }

 private:
    EnuFrame enu_;
    Eigen::Isometry3d enuFromMap_;
    UtmZone zone_;
    Eigen::Vector3d offset_;
    Eigen::Matrix3d rotation_;
};
}  // namespace delio::earth
