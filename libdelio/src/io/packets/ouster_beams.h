#pragma once
#include <Eigen/Core>
#include <vector>

#include "ouster_frame.h"

namespace delio::io {
/** Where every pixel of an Ouster's turn looks: tables that make points of ranges, in the sensor's
 *  frame (x forward, away from the connector). */
class OusterBeams {
 public:
    explicit OusterBeams(const OusterInfo& info);

    /** Metres; `pixel` counts column by column. */
    Eigen::Vector3f point(std::size_t pixel, std::uint32_t range_mm) const {
        const float along = 1e-3F * static_cast<float>(range_mm) - beamOrigin_m_;
        return along * directions_[pixel] + origins_[pixel / rows_];
    }

 private:
    std::size_t rows_;
    float beamOrigin_m_;                       //!< ranges count from the lidar's origin
    std::vector<Eigen::Vector3f> directions_;  //!< a pixel
    std::vector<Eigen::Vector3f> origins_;     //!< a column
};
}  // namespace delio::io
