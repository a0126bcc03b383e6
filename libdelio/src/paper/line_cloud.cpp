#include "paper/line_cloud.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <random>

namespace delio::paper {
namespace {
/** Indices of the points of each (ring, sector), ring-major. */
std::vector<std::vector<Eigen::Index>> polarBins(const Eigen::Matrix3Xf& points,
                                                 const std::vector<std::uint16_t>& rings,
                                                 std::size_t ringCount, std::size_t sectors) {
    std::vector<std::vector<Eigen::Index>> bins(ringCount * sectors);
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const double turn = std::atan2(points(1, i), points(0, i)) / (2 * M_PI) + 0.5;
        const auto sector =
            std::min(sectors - 1, static_cast<std::size_t>(turn * static_cast<double>(sectors)));
        bins[rings[static_cast<std::size_t>(i)] * sectors + sector].push_back(i);
    }
    return bins;
}

struct Line {
    Eigen::Vector3f begin, end;
    float squaredLength = 0;
};

/** One of `count`: std::uniform_int_distribution is not the same in every library. */
std::size_t pick(std::mt19937& random, std::size_t count) {
    return static_cast<std::size_t>((static_cast<std::uint64_t>(random()) * count) >> 32);
}

std::vector<Line> shortestOf(const Eigen::Matrix3Xf& points, const std::vector<Eigen::Index>& upper,
                             const std::vector<Eigen::Index>& lower, std::uint32_t seed,
                             const LineCloudOptions& options) {
    if (upper.empty() || lower.empty()) return {};
    std::mt19937 random(seed);
    std::vector<Line> lines(options.drawn);
    for (auto& line : lines) {
        line.begin = points.col(upper[pick(random, upper.size())]);
        line.end = points.col(lower[pick(random, lower.size())]);
        line.squaredLength = (line.end - line.begin).squaredNorm();
    }
    std::stable_sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) {
        return a.squaredLength < b.squaredLength;
    });
    lines.resize(std::min<std::size_t>(lines.size(), options.kept));
    const auto longest = static_cast<float>(options.max_length * options.max_length);
    const auto useless = [&](const Line& line) {
        return line.squaredLength > longest || !(line.squaredLength > 1e-8F);
    };
    lines.erase(std::remove_if(lines.begin(), lines.end(), useless), lines.end());
    return lines;
}
}  // namespace

LineCloud drawLines(const Eigen::Matrix3Xf& points, const std::vector<std::uint16_t>& rings,
                    const LineCloudOptions& options) {
    LineCloud cloud;
    const std::size_t ringCount =
        rings.empty() ? 0 : *std::max_element(rings.begin(), rings.end()) + 1U;
    if (ringCount < 2) return cloud;
    const std::size_t sectors = options.sectors;
    const auto bins = polarBins(points, rings, ringCount, sectors);
    std::vector<std::vector<Line>> lines((ringCount - 1) * sectors);
    tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t bin) {
        const auto seed = options.seed * 2654435761U + static_cast<std::uint32_t>(bin);
        lines[bin] = shortestOf(points, bins[bin], bins[bin + sectors], seed, options);
    });
    Eigen::Index count = 0;
    for (const auto& part : lines) count += static_cast<Eigen::Index>(part.size());
    cloud.midpoints.resize(3, count);
    cloud.directions.resize(3, count);
    cloud.lengths.resize(count);
    Eigen::Index i = 0;
    for (const auto& part : lines) {
        cloud.drawn += part.empty() ? 0 : options.drawn;
        for (const auto& line : part) {
            const float length = std::sqrt(line.squaredLength);
            cloud.midpoints.col(i) = (line.begin + line.end) / 2;
            cloud.directions.col(i) = (line.end - line.begin) / length;
            cloud.lengths[i] = length;
            ++i;
        }
    }
    return cloud;
}

LineCloud rotated(const LineCloud& lines, const Eigen::Matrix3d& R) {
    LineCloud result = lines;
    result.midpoints = R.cast<float>() * lines.midpoints;
    result.directions = R.cast<float>() * lines.directions;
    return result;
}
}  // namespace delio::paper
