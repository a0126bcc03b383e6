#pragma once
#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "delio/picture/render.h"

namespace mrpt::opengl {
class COpenGLScene;
}

namespace delio::picture {
/** The name of a scene's object that holds the points of a map. */
constexpr const char* kMapName = "map";

/** The name of the object that holds the points removed from the map. */
constexpr const char* kRemovedName = "removed";

/** The name of an object whose x axis points north. */
constexpr const char* kNorthName = "north";

/** How much larger than in a picture of 1080 lines the points of a map are. */
inline double sizeOfPoints(const SnapshotOptions& options) {
    const double lines = std::min(options.width_px / 16.0 * 9, double(options.height_px));
    return std::clamp(lines / 1080, 0.6, 4.0);
}

/** The same of marks and texts. */
inline double sizeOfMarks(const SnapshotOptions& options) {
    return options.marks * sizeOfPoints(options);
}

/** True if the picture is large enough for a legend. */
inline bool hasLegend(const SnapshotOptions& options) {
    return options.width_px >= 480 && options.height_px >= 320;
}

/** Points of a scene that its picture has to show; metres, in the scene's frame. */
struct Content {
    std::vector<Eigen::Vector3d> points;  //!< may contain a few outliers
    std::vector<Eigen::Vector3d> lines;   //!< ends of lines: none is left out
    std::vector<Eigen::Vector3d> grids;   //!< corners: shown where they fall into the picture
    std::size_t cloudSize = 0;            //!< of all clouds of points, sampled or not
    bool empty() const { return points.empty() && lines.empty(); }
};

/** The visible content of the scene's main viewport; large objects are sampled. Points removed from
 *  a map do not count, so that the view is the same with and without them. */
Content contentOf(const mrpt::opengl::COpenGLScene& scene);

/** Typical distance between neighbouring points of a scene's map, if they lie on surfaces; metres.
 *  0 where there is no map. */
double mapSpacing_m(mrpt::opengl::COpenGLScene& scene);

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

/** Distance of the near clipping plane; always in front of the camera. */
double nearClipOf(const View& view);

/** Distance from which a perspective view shows the same width at its middle. */
double distanceOf(const View& view, const SnapshotOptions& options);

/** `pictures` views around the content, which is not empty; one fills the picture as well as it
 *  can, several are all about one middle and of one size. */
std::vector<View> viewsOf(const Content& content, const SnapshotOptions& options,
                          unsigned pictures);
}  // namespace delio::picture
