#pragma once
#include <Eigen/Core>
#include <vector>

namespace delio::scan {
/** What a scan says of a place. */
enum class Place {
    kUnknown,  //!< no beam went there, or one ended before
    kFree,     //!< beams went through
    kTaken     //!< a beam ended there
};

/** The nearest range in each direction of a scan: which space it saw to be free. */
class RangeImage {
 public:
    /** Of no scan: knows nothing. */
    RangeImage() : RangeImage(Eigen::Matrix3Xf(3, 0), 180) {}
    /** `points`: metres, sensor's frame. Directions are told apart by `cell_deg` (degrees of
     * azimuth and of elevation). */
    RangeImage(const Eigen::Matrix3Xf& points, double cell_deg);

    /** `point`: in this scan's sensor frame. Free only where the beams of all neighbouring cells
     *  went on by more than `margin` metres; taken where one of them ended within as much. */
    Place at(const Eigen::Vector3f& point, float margin) const;

 private:
    int rowOf(const Eigen::Vector3f& point) const;
    int columnOf(const Eigen::Vector3f& point) const;

    float perRadian_;
    int rows_, columns_;
    std::vector<float> nearest_;  //!< metres, row by row from below; 0: nothing was seen
};
}  // namespace delio::scan
