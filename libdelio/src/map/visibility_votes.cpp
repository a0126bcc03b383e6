#include "visibility_votes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace delio::map {
namespace {
using Voxel = Eigen::Array3i;

std::uint64_t keyOf(const Voxel& voxel) {
    // 21 bits an axis: blocks within a million to either side of the origin do not mix.
    const auto part = [](int v) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(v >> 3)) & ((1U << 21) - 1);
    };
    return part(voxel.x()) << 42 | part(voxel.y()) << 21 | part(voxel.z());
}

unsigned numberOf(const Voxel& voxel) {
    return static_cast<unsigned>((voxel.z() & 7) << 6 | (voxel.y() & 7) << 3 | (voxel.x() & 7));
}

void count(std::uint16_t& counter) {
    counter += counter < std::numeric_limits<std::uint16_t>::max();
}
}  // namespace

std::vector<OptionField> RemovalOptions::fields() const {
    return {{"enabled", &RemovalOptions::enabled,
             "true: after the drive, remove map points that other scans saw through"},
            {"voxel_size", &RemovalOptions::voxelSize_m, "m; voxel size of the removal", 0.02, 10},
            {"cell_deg", &RemovalOptions::cell_deg, "deg; angular resolution of the range images",
             0.1, 10},
            {"spacing", &RemovalOptions::spacing_m,
             "m; distance between the scans that vote (while standing: one per 0.5 s)", 0, 100}};
}

std::size_t VisibilityVotes::Block::rankOf(unsigned number) const {
    std::size_t rank = 0;
    for (unsigned word = 0; word < number >> 6; ++word)
        rank += static_cast<std::size_t>(__builtin_popcountll(taken[word]));
    const std::uint64_t before = (std::uint64_t{1} << (number & 63)) - 1;
    return rank + static_cast<std::size_t>(__builtin_popcountll(taken[number >> 6] & before));
}

void VisibilityVotes::hit(const Eigen::Vector3d& point, bool moving, std::uint32_t scan) {
    const Eigen::Array3d scaled = point.array() / options_.voxelSize_m;
    const Eigen::Array3d whole = scaled.floor();
    const Voxel voxel = whole.cast<int>();
    Block& block = blocks_[blocks_.insert(keyOf(voxel))];
    if (block.cells.empty())
        block.first = voxel.unaryExpr([](int v) { return static_cast<int>(v & ~7U); });
    const unsigned number = numberOf(voxel);
    const std::size_t rank = block.rankOf(number);
    const auto cell = block.cells.begin() + static_cast<std::ptrdiff_t>(rank);
    if (!block.has(number)) {
        block.taken[number >> 6] |= std::uint64_t{1} << (number & 63);
        const Eigen::Array3d place = (scaled - whole) * 256;
        // Just below a border the difference rounds to 1.
        const auto byte = [&](int axis) {
            return static_cast<std::uint8_t>(std::min(place[axis], 255.0));
        };
        block.cells.insert(cell, {scan, 1, moving, 0, 0, {byte(0), byte(1), byte(2)}});
    } else if (cell->lastScan != scan) {
        cell->lastScan = scan;
        count(cell->hits);
        if (moving) count(cell->moving);
    }
}

template <typename Visit>
void VisibilityVotes::forCells(Block& block, const Visit& visit) {
    std::size_t rank = 0;
    for (int z = 0; z < 8; ++z)
        for (std::uint64_t left = block.taken[static_cast<std::size_t>(z)]; left;
             left &= left - 1) {
            const int number = __builtin_ctzll(left);
            visit(Voxel(block.first + Voxel(number & 7, number >> 3, z)), block.cells[rank++]);
        }
}

Eigen::Vector3f VisibilityVotes::pointOf(const Voxel& voxel, const Cell& cell) const {
    const Eigen::Array3d within(cell.place[0], cell.place[1], cell.place[2]);
    return ((voxel.cast<double>() + (within + 0.5) / 256) * options_.voxelSize_m)
        .matrix()
        .cast<float>();
}

void VisibilityVotes::look(const odometry::RangeImage& view, const Eigen::Isometry3d& sensorInWorld,
                           float reach_m) {
    // Farther away small objects lie between two rings.
    constexpr float kGap_m = 0.7F, kNearest_m = 2;
    const float farthest_m = std::min(reach_m, kGap_m / view.ringSpacing());
    const Eigen::Isometry3f toSensor = sensorInWorld.inverse().cast<float>();
    const auto block_m = static_cast<float>(8 * std::sqrt(3.0) * options_.voxelSize_m);
    const auto margin = static_cast<float>(options_.margin_m);
    tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t i) {
        Block& block = blocks_[static_cast<std::uint32_t>(i)];
        const Eigen::Vector3f corner =
            (block.first.cast<double>() * options_.voxelSize_m).matrix().cast<float>();
        if ((toSensor * corner).norm() > farthest_m + block_m) return;
        forCells(block, [&](const Voxel& voxel, Cell& cell) {
            const Eigen::Vector3f point = toSensor * pointOf(voxel, cell);
            const float range_m = point.norm();
            if (range_m < kNearest_m || range_m > farthest_m) return;
            const auto place = view.at(point, margin);
            if (place == odometry::Place::kFree) count(cell.free);
            if (place == odometry::Place::kTaken) count(cell.taken);
        });
    });
}

const VisibilityVotes::Cell* VisibilityVotes::find(const Voxel& voxel) const {
    const Block* block = blocks_.find(keyOf(voxel));
    const unsigned number = numberOf(voxel);
    return block && block->has(number) ? &block->cells[block->rankOf(number)] : nullptr;
}

const VisibilityVotes::Cell* VisibilityVotes::at(const Eigen::Vector3d& point) const {
    return find((point.array() / options_.voxelSize_m).floor().cast<int>());
}

/** Beside the voxel and above it: what is below dynamic objects is the ground. */
VisibilityVotes::Around VisibilityVotes::around(const Voxel& voxel, int reach) const {
    Around around;
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = 0; z <= reach + 1; ++z) {
                if (x == 0 && y == 0 && z == 0) continue;
                const Cell* other = find(voxel + Voxel(x, y, z));
                around.all += other != nullptr;
                around.dynamic += other && other->seed;
            }
    return around;
}

bool VisibilityVotes::isVotedDynamic(const Cell& cell) const {
    // With more votes per label, static voxels with wrong labels are removed; with fewer, the lower
    // parts of vehicles stay.
    constexpr unsigned kPerLabel = 3;
    const bool isLabelled = 2 * cell.moving > cell.hits;
    const unsigned free = cell.free + (isLabelled ? kPerLabel : 0);
    return free >= options_.witnesses && options_.freePerTaken * free > cell.taken;
}

/** Beams pass between the parts of what is thin or sparse, but not between those of a vehicle. */
bool VisibilityVotes::isOutvoted(const Voxel& voxel) const {
    constexpr int kReach = 3, kLeast = 4;
    const auto [all, dynamic] = around(voxel, kReach);
    return all >= kLeast && 2 * dynamic < all;
}

/** The lowest parts of dynamic objects are next to and below the rest, above the ground. */
bool VisibilityVotes::isSurrounded(const Voxel& voxel) const {
    constexpr int kReach = 2, kLeast = 4;
    const auto [all, dynamic] = around(voxel, kReach);
    return dynamic >= kLeast && dynamic >= options_.grownShare * all;
}

void VisibilityVotes::decide() {
    constexpr unsigned kLittle = 3;
    const auto forAll = [&](const auto& visit) {
        tbb::parallel_for(std::size_t{0}, blocks_.size(), [&](std::size_t i) {
            forCells(blocks_[static_cast<std::uint32_t>(i)], visit);
        });
    };
    forAll([&](const Voxel&, Cell& cell) { cell.seed = isVotedDynamic(cell); });
    forAll([&](const Voxel& voxel, Cell& cell) {
        cell.outvoted = cell.seed && cell.taken >= kLittle && isOutvoted(voxel);
    });
    forAll([&](const Voxel&, Cell& cell) { cell.seed = cell.seed && !cell.outvoted; });
    forAll([&](const Voxel& voxel, Cell& cell) {
        const bool isKnown = cell.free == 0 && cell.taken >= kLittle;
        cell.grown = !cell.seed && !isKnown && isSurrounded(voxel);
    });
}

bool VisibilityVotes::isDynamic(const Eigen::Vector3d& point) const {
    const Cell* cell = at(point);
    return cell && (cell->seed || cell->grown);
}

std::uint16_t VisibilityVotes::observations(const Eigen::Vector3d& point) const {
    const Cell* cell = at(point);
    return cell ? cell->hits : std::uint16_t{0};
}
}  // namespace delio::map
