#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/core/increment.h"

namespace delio {
/** How well a scan was registered. */
struct Quality {
    std::size_t matches = 0;  //!< number of correspondences
    double residual_m = 0;    //!< root mean square of their distances
    /** Observability of the rotation about three axes, 0 to 1, increasing; 0 if the scan was
     *  predicted. */
    Eigen::Vector3d rotationObservability = Eigen::Vector3d::Zero();
    /** Observability of the translation along three axes. */
    Eigen::Vector3d translationObservability = Eigen::Vector3d::Zero();
    /** Unit vectors in the sensor's frame at this scan about which the prediction was kept; all
     * three axes where the scan was predicted, or was the first. */
    Eigen::Matrix3Xd unobservedRotation;
    /** The same for the translation; also an axis along which few planes, all in one direction,
     * show it: they may belong to a vehicle that drives along. */
    Eigen::Matrix3Xd unobservedTranslation;
};

/** Points of a scan that were used, de-skewed to the stamp: metres, sensor frame, vertical angles
 *  corrected. */
struct UsedPoints {
    Eigen::Matrix3Xf points;             //!< one point per column
    std::vector<std::uint32_t> indices;  //!< index of each point in the original scan
    /** 1 for each point on a dynamic object; empty if these are not searched. */
    std::vector<std::uint8_t> dynamic;
};

/** Registration of two scans, in addition to the chain of steps. */
struct Link {
    Increment increment;  //!< maps the later sensor frame to the earlier one
    double overlap = 0;   //!< fraction of the later scan that the earlier one saw too, 0 to 1
};

/** Features of a scan for registration with other scans than the last one. */
class ScanFeatures {
 public:
    virtual ~ScanFeatures() = default;
    /** Against a scan before it by the same odometry; `guess` maps this sensor frame to the earlier
     *  one. Nothing where the two cannot be registered. */
    virtual std::optional<Link> linkTo(const ScanFeatures& earlier,
                                       const Eigen::Isometry3d& guess) const = 0;
};

/** The pose of an earlier scan, which later scans have corrected. */
struct CorrectedPose {
    std::size_t scansAgo = 0;                                //!< 1: the scan before
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  //!< sensor's frame then to that now
    bool registered = false;  //!< it was registered there: it is lost no more
    /** Only its pose at its stamp is known better; what it saw stays where it is. */
    bool staysInPlace = false;
};

/** A named value. */
using Named = std::pair<std::string, double>;

/** Result of an odometry for one scan, independent of the method. */
struct Step {
    /** Maps the sensor's frame at this scan to that at the scan before; identity for the first.
     *  The covariance of a predicted one is the motion model's. */
    Increment increment;
    /** Earlier scans that are now known to have been elsewhere, oldest first: after the
     *  first scans of a map, after a start in motion, and after a loss; and the scan before, where
     *  its stamp lies between both scans' times. `increment` leads from where the scan before was
     *  said to be. */
    std::vector<CorrectedPose> corrected;
    bool predicted = false;  //!< the scan could not be registered: `increment` is the prediction
    std::string reason;      //!< why; empty where it was registered
    /** Where the sensor went since it was tracked last is not known: the scan was not found in the
     *  map, or an axis has not been observed since the motion was known last. */
    bool lost = false;
    /** Number of the track that the scan belongs to. A new track begins with a new map, after scans
     *  that were not found in the one before: only a prediction links both. A scan with a smaller
     *  number than the scan before it was found in that earlier map: the scans between belong to
     *  the earlier track, too. */
    std::size_t track = 0;
    /** Wheels say where the sensor went along the axes that were not observed. */
    bool carried = false;
    bool searched = false;     //!< the motion was searched over a wide range
    bool interrupted = false;  //!< after a time gap or clock jump: the interval is unknown
    /** Registered along and about every axis, and slower than 0.1 m/s and 2 deg/s. */
    bool standing = false;
    Quality quality;            //!< of the registration
    UsedPoints used;            //!< points for map and pictures
    std::size_t notFinite = 0;  //!< points dropped: a coordinate was NaN or infinite
    bool deskewed = false;      //!< its points had times
    /** Of each stage in its order: every scan of an odometry has the same ones. */
    std::vector<Named> times_ms;
    std::vector<Named> details;                    //!< the method's own figures, likewise
    std::shared_ptr<const ScanFeatures> features;  //!< null if the method keeps none
};
}  // namespace delio
