#pragma once
#include <Eigen/Core>
#include <functional>
#include <string>

namespace delio::io {
/** Calls `take` for each finite point of a .ply, .pcd or .las file, as it has them (doubles, any
 *  origin). The file is read in blocks; only a compressed .pcd is read at once.
 *  @return coordinate system of a .las as OGC WKT; empty: unknown
 *  Throws Error, which names the file, for another kind of file, and for one that is missing, cut
 *  off, without x, y or z, or contradicts itself. */
std::string forEachPoint(const std::string& path,
                         const std::function<void(const Eigen::Vector3d& point)>& take);
}  // namespace delio::io
