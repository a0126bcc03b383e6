#include "places/bytes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace delio {
namespace {
constexpr float kUnit_m = 0.005F;
constexpr float kFarthest_m = 160;
using Rounded = std::array<std::int16_t, 3>;

/** Columns of cells of 1.28 m, one after the other; within one from below. */
bool before(const Rounded& a, const Rounded& b) {
    const auto key = [](const Rounded& p) {
        return std::make_tuple(p[0] >> 8, p[1] >> 8, p[2], p[0], p[1]);
    };
    return key(a) < key(b);
}
}  // namespace

void put(ByteWriter& bytes, const Eigen::Matrix3Xf& points) {
    std::vector<Rounded> rounded;
    rounded.reserve(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        if (!(points.col(i).cwiseAbs().maxCoeff() < kFarthest_m)) continue;
        Rounded point;
        for (int k = 0; k < 3; ++k)
            point[static_cast<std::size_t>(k)] =
                static_cast<std::int16_t>(std::lround(points(k, i) / kUnit_m));
        rounded.push_back(point);
    }
    std::sort(rounded.begin(), rounded.end(), before);
    // Differences, axis by axis, low bytes and high bytes apart: the high ones are mostly zero.
    bytes.put<std::uint64_t>(rounded.size());
    for (std::size_t k = 0; k < 3; ++k) {
        std::vector<std::uint8_t> low, high;
        std::int16_t last = 0;
        for (const auto& point : rounded) {
            const auto difference = static_cast<std::uint16_t>(point[k] - last);
            // 0, -1, 1, -2 ... become 0, 1, 2, 3 ...
            const auto folded =
                static_cast<std::uint16_t>((difference << 1) ^ (difference & 0x8000 ? 0xFFFF : 0));
            low.push_back(static_cast<std::uint8_t>(folded & 0xFF));
            high.push_back(static_cast<std::uint8_t>(folded >> 8));
            last = point[k];
        }
        bytes.putAll(low.data(), low.size());
        bytes.putAll(high.data(), high.size());
    }
}

Eigen::Matrix3Xf getPoints(ByteReader& bytes) {
    const auto count = bytes.get<std::uint64_t>();
    Eigen::Matrix3Xf points;
    for (Eigen::Index k = 0; k < 3; ++k) {
        const auto low = bytes.getAll<std::uint8_t>(), high = bytes.getAll<std::uint8_t>();
        if (low.size() != count || high.size() != count) throw std::out_of_range("points");
        if (k == 0) points.resize(3, static_cast<Eigen::Index>(count));
        std::uint16_t last = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto folded = static_cast<std::uint16_t>(low[i] | high[i] << 8);
            last = static_cast<std::uint16_t>(last + ((folded >> 1) ^ (folded & 1 ? 0xFFFF : 0)));
            points(k, static_cast<Eigen::Index>(i)) =
                kUnit_m * static_cast<float>(static_cast<std::int16_t>(last));
        }
    }
    return points;
}
}  // namespace delio
