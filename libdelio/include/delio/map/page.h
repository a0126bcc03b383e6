#pragma once
#include <Eigen/Geometry>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "delio/map/map_point.h"

namespace delio::map {
/** Content of a page, in the map's frame. All but the points may be empty. */
struct PageContent {
    std::string title;                          //!< any text
    MapPoints points;                           //!< static points
    MapPoints dynamic;                          //!< dynamic points
    std::vector<Eigen::Isometry3d> trajectory;  //!< final poses of the vehicle
    std::vector<Eigen::Isometry3d> odometry;  //!< before the graph; not shown where it is the same
    std::vector<std::pair<std::size_t, std::size_t>> loops;  //!< indices of `trajectory`
    std::vector<Eigen::Isometry3d> truth;                    //!< true poses, where they are known
    std::optional<Eigen::Vector3d> north;  //!< its direction, where the map is georeferenced
};

/** A page has at most so many points; a larger map is thinned evenly, and the page says so. A
 * laptop draws them fluently, and the file fits into a mail. */
constexpr std::size_t kMostPagePoints = 2000000;
/** The same for dynamic points. */
constexpr std::size_t kMostPageDynamic = 200000;

/** Where the build found three.js, which draws a page. */
std::string threeJsFile();

/** Writes one HTML file with which a browser shows the map, without a network and without any other
 *  file; the same bytes for the same content. A point of it lies within a millimetre of the map's,
 *  its height above the ground within a centimetre. `threeJs`, and its
 *  examples that lie beside it (OrbitControls, LineSegments2), are put into it.
 *  Error where there is no point, a loop names no pose, or three.js is not there. */
void savePage(const PageContent& content, const std::string& path,
              const std::string& threeJs = threeJsFile());

/** The same page for a map that grows: it asks the server that it came from for "/live" again and
 *  again, as delio-slam --serve answers it. Error where three.js is not there. */
std::string livePage(const std::string& title, const std::string& threeJs = threeJsFile());
}  // namespace delio::map
