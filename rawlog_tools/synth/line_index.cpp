#include "line_index.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
int cellOf(double metres, double size) { return static_cast<int>(std::floor(metres / size)); }

std::uint64_t keyOf(int column, int row) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(column)) << 32 |
           static_cast<std::uint32_t>(row);
}
}  // namespace

void LineIndex::add(const Segment& segment) {
    const Eigen::Vector2d middle = (segment.a + segment.b) / 2;
    cells_[keyOf(cellOf(middle.x(), kCell_m), cellOf(middle.y(), kCell_m))].push_back(segment);
}

const LineIndex::Cell* LineIndex::cell(int column, int row) const {
    const auto found = cells_.find(keyOf(column, row));
    return found == cells_.end() ? nullptr : &found->second;
}

LineIndex::Nearest LineIndex::nearest(const Eigen::Vector2d& place, double reach,
                                      double before_s) const {
    Nearest best{reach, nullptr, false};
    const auto compare = [&](const Segment& segment) {
        if (segment.s >= before_s) return;
        const Eigen::Vector2d along = segment.b - segment.a;
        const double u = (place - segment.a).dot(along) / along.squaredNorm();
        const double onto = std::clamp(u, 0.0, 1.0);
        const double distance = (place - segment.a - onto * along).norm();
        if (distance < best.distance)
            best = {distance, &segment, (u < 0 && segment.first) || (u > 1 && segment.last)};
    };
    const int column = cellOf(place.x(), kCell_m), row = cellOf(place.y(), kCell_m);
    // Ring after ring of cells; what is in ring n + 1 is at least n cells away.
    const int rings = static_cast<int>(std::ceil((reach + kLongest_m) / kCell_m));
    for (int ring = 0; ring <= rings; ++ring) {
        if (best.distance < (ring - 1) * kCell_m - kLongest_m) break;
        for (int i = -ring; i <= ring; ++i)
            for (int j = -ring; j <= ring; j += std::abs(i) == ring ? 1 : std::max(1, 2 * ring))
                if (const Cell* some = cell(column + i, row + j))
                    for (const auto& segment : *some) compare(segment);
    }
    return best;
}

void LineIndex::visit(const Eigen::Vector2d& place, double reach,
                      const std::function<void(const Segment&)>& use) const {
    const int column = cellOf(place.x(), kCell_m), row = cellOf(place.y(), kCell_m);
    const int rings = static_cast<int>(std::ceil(reach / kCell_m));
    for (int i = -rings; i <= rings; ++i)
        for (int j = -rings; j <= rings; ++j)
            if (const Cell* some = cell(column + i, row + j))
                for (const auto& segment : *some)
                    if ((segment.a - place).norm() < reach) use(segment);
}
}  // namespace delio::synth
