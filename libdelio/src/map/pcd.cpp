#include "delio/map/cloud_files.h"

#include <cmath>
#include <cstring>

#include "delio/core/error.h"
#include "delio/core/text.h"
#include "formats/pcd.h"
#include "point_file.h"

namespace delio::map {
namespace {
/** PCL's packed colour: 0x00rrggbb in the bytes of a float. */
void packColour(const mrpt::img::TColor& colour, char* to) {
    const std::uint32_t rgb =
        std::uint32_t{colour.R} << 16 | std::uint32_t{colour.G} << 8 | colour.B;
    std::memcpy(to, &rgb, sizeof(rgb));
}

MapPoints pointsOf(const io::PcdHeader& header, PointFile& file) {
    if (header.data == "binary_compressed")
        file.refuse(
            "compressed data is not supported here; convert it with: pcl_convert_pcd_ascii_binary "
            "IN.pcd OUT.pcd 1");
    if (header.data != "ascii" && header.data != "binary")
        file.refuse("unsupported DATA '" + header.data + "'");
    if (!header.points) file.refuse("the number of points is missing");
    return file.points(io::columnsOf(header, file), *header.points, header.data == "ascii");
}

Eigen::Isometry3d viewpointOf(const io::PcdHeader& header, const std::string& path) {
    constexpr double kNearlyUnit = 0.01;
    const auto refuse = [&](const std::string& why) { throw Error("'" + path + "': " + why); };
    if (header.viewpoint.empty()) refuse("its VIEWPOINT is missing");
    std::vector<double> numbers;
    for (const auto& word : header.viewpoint)
        if (const auto number = numberIn<double>(word); number && std::isfinite(*number))
            numbers.push_back(*number);
    if (numbers.size() != 7) refuse("its VIEWPOINT is not seven numbers");
    const Eigen::Quaterniond turned(numbers[3], numbers[4], numbers[5], numbers[6]);
    if (std::abs(turned.norm() - 1) > kNearlyUnit)
        refuse("the rotation of its VIEWPOINT is not a unit quaternion");
    Eigen::Isometry3d pose(turned.normalized());
    pose.translation() << numbers[0], numbers[1], numbers[2];
    return pose;
}
}  // namespace

void savePcd(const MapPoints& points, const std::string& path, const Colouring& colouring) {
    std::string names, sizes, types, counts;
    auto columns = writtenColumns(true);
    columns.push_back({"rgb", 'F', 4});
    for (const auto& column : columns) {
        names += " " + column.name;
        sizes += " " + std::to_string(column.bytes);
        types += std::string(" ") + column.kind;
        counts += " 1";
    }
    const std::string count = std::to_string(points.size());
    const std::string header = "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" +
                               names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts +
                               "\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
                               count + "\nDATA binary\n";
    writePoints(path, header, points, coloursOf(points, colouring), 4, packColour);
}

MapPoints loadPcd(const std::string& path) {
    PointFile file(path, "PCD");
    return pointsOf(io::readPcdHeader(file), file);
}

MapPoints loadPcd(const std::string& path, Eigen::Isometry3d& viewpoint) {
    PointFile file(path, "PCD");
    const auto header = io::readPcdHeader(file);
    viewpoint = viewpointOf(header, path);
    return pointsOf(header, file);
}
}  // namespace delio::map
