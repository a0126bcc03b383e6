#include "places/place_index.h"

#include <tbb/parallel_for.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

namespace delio::places {
namespace {
constexpr double kLarge_m = 2;  // edge of a cell
constexpr int kTurns = 72;
constexpr int kReach = 10;             // cells from the middle of a place
constexpr std::size_t kSide = 24;      // shifts in a row; those beyond the reach are not looked at
constexpr int kRows = 2 * kReach + 1;  // of shifts

/** The best `kMost`, whose headings are `kApart_rad` apart: a room may be as similar to itself
 *  turned round. */
std::vector<Shift> distinct(std::vector<Shift> shifts) {
    constexpr std::size_t kMost = 4;
    constexpr double kApart_rad = M_PI / 6;
    std::stable_sort(shifts.begin(), shifts.end(),
                     [](const Shift& a, const Shift& b) { return a.overlap > b.overlap; });
    std::vector<Shift> kept;
    for (const auto& shift : shifts) {
        const auto isNear = [&](const Shift& other) {
            return std::abs(std::remainder(shift.yaw - other.yaw, 2 * M_PI)) < kApart_rad;
        };
        if (kept.size() < kMost && std::none_of(kept.begin(), kept.end(), isNear))
            kept.push_back(shift);
    }
    return kept;
}
}  // namespace

struct PlaceIndex::Turned {
    double yaw = 0;
    double bits = 0;
    std::vector<Cell> cells;
};

Raster PlaceIndex::rasterOf(const HeightImage& image, double yaw, int margin) {
    if (image.bands().empty()) return {};
    const Eigen::Matrix2Xi cells =
        (Eigen::Rotation2Dd(yaw).toRotationMatrix() * image.cells() / kLarge_m)
            .array()
            .floor()
            .cast<int>();
    return {cells, image.bands(), margin};
}

void PlaceIndex::add(const HeightImage& image) {
    places_.push_back(rasterOf(image, 0, static_cast<int>(kSide)));
}

std::vector<PlaceIndex::Turned> PlaceIndex::turnsOf(const HeightImage& cloud) {
    std::vector<Turned> turns(kTurns);
    for (int i = 0; i < kTurns; ++i) {
        auto& turned = turns[static_cast<std::size_t>(i)];
        turned.yaw = 2 * M_PI * i / kTurns;
        const Raster raster = rasterOf(cloud, turned.yaw, 0);
        for (int y = 0; y < raster.height; ++y)
            for (int x = 0; x < raster.width; ++x) {
                const auto bands = raster.bands[raster.at(x, y)];
                if (bands == 0) continue;
                turned.cells.push_back({raster.x0 + x, raster.y0 + y, bands});
                turned.bits += bitsOf(bands);
            }
    }
    return turns;
}

/** At each shift, how many bands of a turned image lie on those of the place: a row of shifts is
 *  eight times `kWords` bytes that are added up as words. */
class PlaceIndex::Overlaps {
 public:
    explicit Overlaps(const Raster& place)
        : place_(place), area_(place.bands.size()), layers_(kBands * area_) {
        for (std::size_t band = 0; band < kBands; ++band)
            for (std::size_t i = 0; i < area_; ++i)
                layers_[band * area_ + i] = (place.bands[i] >> band) & 1;
    }

    /** Current search window. */
    void take(const Turned& turned) {
        seen_.clear();
        for (const auto& cell : turned.cells) {
            const int x = cell.x - kReach - place_.x0, y = cell.y - kReach - place_.y0;
            // The place ends in a margin as wide as the shifts.
            if (x < 0 || x + static_cast<int>(kSide) > place_.width || y < 0 ||
                y + kRows > place_.height)
                continue;
            for (std::size_t band = 0; band < kBands; ++band)
                if ((cell.bands >> band & 1) != 0) seen_.push_back(band * area_ + place_.at(x, y));
        }
    }

    using Row = std::array<std::uint32_t, kSide>;
    /** Of shifts by `dy` rows. */
    Row row(int dy) const {
        constexpr std::size_t kMost = 255;  // that a byte can count
        Row row{};
        const std::uint8_t* first = layers_.data() + place_.at(0, dy);
        for (std::size_t begin = 0; begin < seen_.size(); begin += kMost) {
            std::array<std::uint64_t, kWords> counts{};
            for (std::size_t i = begin; i < std::min(begin + kMost, seen_.size()); ++i) {
                std::array<std::uint64_t, kWords> here;
                std::memcpy(here.data(), first + seen_[i], kSide);
                for (std::size_t word = 0; word < kWords; ++word) counts[word] += here[word];
            }
            std::array<std::uint8_t, kSide> bytes;
            std::memcpy(bytes.data(), counts.data(), kSide);
            for (std::size_t dx = 0; dx < kSide; ++dx) row[dx] += bytes[dx];
        }
        return row;
    }

 private:
    static constexpr std::size_t kBands = 8, kWords = kSide / sizeof(std::uint64_t);
    static_assert(kSide == kWords * sizeof(std::uint64_t) && kRows <= static_cast<int>(kSide));

    const Raster& place_;
    std::size_t area_;
    std::vector<std::uint8_t> layers_;  //!< of each band, where the place has it: 0 or 1
    std::vector<std::size_t> seen_;     //!< in layers_, of each band of each cell, unshifted
};

/** The best shift of each heading; of these the best, and others that are clearly elsewhere. */
std::vector<Shift> PlaceIndex::best(const Raster& place, const std::vector<Turned>& turns) {
    std::vector<Shift> best;
    best.reserve(turns.size());
    Overlaps overlaps(place);
    for (const auto& turned : turns) {
        overlaps.take(turned);
        Shift shift;
        std::uint32_t most = 0;
        for (int dy = 0; dy < kRows; ++dy) {
            const auto row = overlaps.row(dy);
            for (int dx = 0; dx < kRows; ++dx) {
                const std::uint32_t bits = row[static_cast<std::size_t>(dx)];
                if (bits <= most) continue;
                most = bits;
                shift = {turned.yaw,
                         {kLarge_m * (dx - kReach), kLarge_m * (dy - kReach), 0},
                         bits / std::max(1.0, turned.bits)};
            }
        }
        best.push_back(shift);
    }
    return distinct(std::move(best));
}

std::vector<PlaceMatch> PlaceIndex::find(const HeightImage& cloud, std::size_t most) const {
    std::vector<std::size_t> all(places_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return find(cloud, all, most);
}

std::vector<PlaceMatch> PlaceIndex::find(const HeightImage& cloud,
                                         const std::vector<std::size_t>& places,
                                         std::size_t most) const {
    const auto turns = turnsOf(cloud);
    std::vector<std::vector<Shift>> shifts(places.size());
    tbb::parallel_for(std::size_t{0}, places.size(),
                      [&](std::size_t i) { shifts[i] = best(places_[places[i]], turns); });
    std::vector<PlaceMatch> matches;
    for (std::size_t i = 0; i < places.size(); ++i)
        for (const auto& shift : shifts[i]) matches.push_back({places[i], shift});
    std::stable_sort(matches.begin(), matches.end(), [](const PlaceMatch& a, const PlaceMatch& b) {
        return a.shift.overlap > b.shift.overlap;
    });
    if (matches.size() > most) matches.resize(most);
    return matches;
}
}  // namespace delio::places
