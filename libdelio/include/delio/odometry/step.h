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
    std::size_t matches = 0;  //!< correspondences that the result stands on
    double residual_m = 0;    //!< root mean square of their distances
    /** How well they fix the rotation about three axes, 0 to 1, rising; 0 where the scan was
     * predicted. */
    Eigen::Vector3d rotationObservability = Eigen::Vector3d::Zero();
    /** The same of the translation along three axes. */
    Eigen::Vector3d translationObservability = Eigen::Vector3d::Zero();
    /** Unit vectors in the sensor's frame at this scan about which the prediction was kept; all
     * three axes where the scan was predicted, or was the first. */
    Eigen::Matrix3Xd unobservedRotation;
    Eigen::Matrix3Xd unobservedTranslation;  //!< the same along which
};

/** The points of a scan that were used, as the sensor would have seen them all at once at the
 *  stamp: metres, its frame, vertical angles corrected. */
struct UsedPoints {
    Eigen::Matrix3Xf points;             //!< a point a column
    std::vector<std::uint32_t> indices;  //!< of each in the scan as it came
    /** 1 for each that belongs to a dynamic object; empty where these are not looked for. */
    std::vector<std::uint8_t> dynamic;
};

/** One scan measured against another, beside the chain of steps. */
struct Link {
    Increment increment;  //!< maps the later sensor frame to the earlier one
    double overlap = 0;   //!< share of the later scan that the earlier one saw too, 0 to 1
};

/** What a method keeps of a scan to register it with others than the last one. */
class ScanFeatures {
 public:
    virtual ~ScanFeatures() = default;
    /** Against a scan before it by the same odometry; `guess` maps this sensor frame to the earlier
     *  one. Nothing where the two cannot be registered. */
    virtual std::optional<Link> linkTo(const ScanFeatures& earlier,
                                       const Eigen::Isometry3d& guess) const = 0;
};

/** A figure under its name. */
using Named = std::pair<std::string, double>;

/** What an odometry says of one scan; it means the same whatever the method. */
struct Step {
    /** Maps the sensor's frame at this scan to that at the scan before; identity for the first.
     *  The covariance of a predicted one is the motion model's. */
    Increment increment;
    bool predicted = false;    //!< the scan could not be registered: `increment` is the prediction
    std::string reason;        //!< why; empty where it was registered
    /** Where the sensor went since it was tracked last is not known: the scan was not found in the
     *  map, or an axis has not been observed since the motion was known last. */
    bool lost = false;
    bool searched = false;     //!< not only from the prediction: all about it
    bool interrupted = false;  //!< a pause or a clock that was set: the time before it is not known
    /** Registered along and about every axis, and slower than 0.1 m/s and 2 deg/s. */
    bool standing = false;
    Quality quality;            //!< of the registration
    UsedPoints used;            //!< what the map and the pictures are made of
    std::size_t notFinite = 0;  //!< points dropped: a coordinate was NaN or infinite
    bool deskewed = false;      //!< its points had times
    /** Of each stage in its order: every scan of an odometry has the same ones. */
    std::vector<Named> times_ms;
    std::vector<Named> details;                    //!< the method's own figures, likewise
    std::shared_ptr<const ScanFeatures> features;  //!< none where the method keeps none
};
}  // namespace delio
