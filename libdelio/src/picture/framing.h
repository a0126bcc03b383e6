#pragma once
#include <Eigen/Core>
#include <vector>

#include "content.h"
#include "delio/picture/view.h"

namespace delio::picture {
/** Opening angle of the camera, from the lower to the upper edge. */
constexpr double kVerticalView_deg = 30;

/** Where a camera stands: pure geometry, metres, in the scene's frame. */
struct View {
    Eigen::Vector3d right, up, back;   //!< axes of the camera; back: from content to camera
    Eigen::Vector3d middle;            //!< what is in the middle of the picture
    double distance = 1;               //!< of the camera from the middle
    double metresAcross = 1;           //!< at the middle
    double magnification = 1;          //!< by zoom_m, beyond what shows everything
    double nearest = 0, farthest = 0;  //!< depth of the whole content, from the camera
};

/** Where the view is cut off in front: in perspective that cannot be at or behind the camera. */
double nearClipOf(const View& view);

/** From where a perspective view shows at its middle what this one shows. */
double distanceOf(const View& view, const SnapshotOptions& options);

/** `pictures` views around the content, which is not empty; one fills the picture as well as it
 *  can, several are all about one middle and of one size. */
std::vector<View> viewsOf(const Content& content, const SnapshotOptions& options,
                          unsigned pictures);
}  // namespace delio::picture
