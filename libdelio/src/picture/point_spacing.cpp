#include "point_spacing.h"

#include <mrpt/opengl/CPointCloudColoured.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "marks.h"

namespace delio::picture {
using mrpt::opengl::CPointCloudColoured;

namespace {
/** In how full a cell a typical point lies. */
double pointsPerCell(const CPointCloudColoured& cloud, double cell_m) {
    std::unordered_map<std::uint64_t, std::uint32_t> counts;
    std::vector<std::uint64_t> cells(cloud.size());
    const auto part = [&](float v) {
        constexpr std::int64_t kHalf = 1 << 20;
        const double at = std::clamp(std::floor(double{v} / cell_m), -1.0 * kHalf, kHalf - 1.0);
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(at) + kHalf);
    };
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto& p = cloud.getPoint3Df(i);
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        cells[i] = part(p.x) << 42 | part(p.y) << 21 | part(p.z);
        ++counts[cells[i]];
    }
    std::vector<std::uint32_t> fullness;
    fullness.reserve(cells.size());
    for (const auto cell : cells) fullness.push_back(counts[cell]);
    const auto middle = fullness.begin() + static_cast<std::ptrdiff_t>(fullness.size() / 2);
    std::nth_element(fullness.begin(), middle, fullness.end());
    return *middle;
}
}  // namespace

double mapSpacing_m(mrpt::opengl::COpenGLScene& scene) {
    const auto cloud = std::dynamic_pointer_cast<CPointCloudColoured>(scene.getByName(kMapName));
    if (!cloud || cloud->empty()) return 0;
    constexpr double kEnough = 12, kSmallest_m = 0.25, kLargest_m = 64;
    for (double cell_m = kSmallest_m; cell_m <= kLargest_m; cell_m *= 2)
        if (const double points = pointsPerCell(*cloud, cell_m); points >= kEnough)
            return cell_m / std::sqrt(points);
    return 0;
}
}  // namespace delio::picture
