#include "delio/loops/free_space.h"

#include <array>

#include "core/voxel_grid.h"

namespace delio::loops {
namespace {
constexpr double kCell_m = HeightImage::kCell_m;

std::uint64_t cellAt(double x, double y) {
    return voxelKey(floorOf(x / kCell_m), floorOf(y / kCell_m), 0);
}
}  // namespace

FreeSpace::FreeSpace(const HeightImage& image, const Eigen::Matrix3Xf& points) {
    const auto cells = image.cells();
    for (Eigen::Index i = 0; i < cells.cols(); ++i)
        standing_.insert(cellAt(cells(0, i), cells(1, i)));
    constexpr std::array<double, 3> kBeside{-kCell_m, 0, kCell_m};
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto x = static_cast<double>(points(0, i)), y = static_cast<double>(points(1, i));
        bool isBare = true;
        for (const double dx : kBeside)
            for (const double dy : kBeside)
                isBare =
                    isBare && standing_.find(cellAt(x + dx, y + dy)) == VoxelIndex::kNone;
        if (isBare) bare_.insert(cellAt(x, y));
    }
}

double FreeSpace::builtOn(const HeightImage& other, const Eigen::Isometry3d& pose) const {
    constexpr std::uint8_t kUpright = 2 | 4;  // 1 to 2 m, and 2 to 4 m
    double bare = 0, seen = 0;
    const auto cells = other.cells();
    for (Eigen::Index i = 0; i < cells.cols(); ++i) {
        if ((other.bands()[static_cast<std::size_t>(i)] & kUpright) != kUpright) continue;
        const Eigen::Vector3d at = pose * Eigen::Vector3d(cells(0, i), cells(1, i), 0);
        const auto cell = cellAt(at.x(), at.y());
        const bool isBare = bare_.find(cell) != VoxelIndex::kNone;
        bare += isBare;
        seen += isBare || standing_.find(cell) != VoxelIndex::kNone;
    }
    return seen > 0 ? bare / seen : 0;
}
}  // namespace delio::loops
