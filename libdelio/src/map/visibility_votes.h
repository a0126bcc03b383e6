#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "core/voxel_table.h"
#include "delio/map/map_builder.h"
#include "odometry/range_image.h"

namespace delio::map {
/** What the scans of a whole drive say of each voxel in which they saw something: how many saw it,
 *  how many of these took it for a part of what moves, and how many, before or later, looked
 * through it. (The idea of Removert, Kim and Kim, IROS 2020, and of DUFOMap, Duberg et al., RA-L
 * 2024; voted by range images instead of cast rays.) First all hits, then all looks, then decide().
 *  World frame, metres. */
class VisibilityVotes {
 public:
    explicit VisibilityVotes(const RemovalOptions& options) : options_(options) {}

    /** Scan number `scan` saw something at `point`; `moving`: as a part of what moves. All hits of
     *  a scan must come one after the other. */
    void hit(const Eigen::Vector3d& point, bool moving, std::uint32_t scan);

    /** Asks a scan of every voxel within `reach_m`. */
    void look(const odometry::RangeImage& view, const Eigen::Isometry3d& sensorInWorld,
              float reach_m);

    /** Marks voxels as dynamic. First those that enough scans looked through; a label as moving by
     *  most of the scans that hit the voxel counts as several looks. Of these, a voxel that several
     *  scans hit is static again if most of the voxels around it are static: leaves, bars. Finally,
     *  a voxel of which little is known is dynamic if most of the voxels around it are. */
    void decide();

    /** After decide(). False where nothing was hit. */
    bool isDynamic(const Eigen::Vector3d& point) const;

    /** Scans that hit its voxel. */
    std::uint16_t observations(const Eigen::Vector3d& point) const;

 private:
    using Voxel = Eigen::Array3i;
    struct Cell {
        std::uint32_t lastScan;
        std::uint16_t hits = 0, moving = 0, free = 0, taken = 0;
        std::array<std::uint8_t, 3> place;  //!< of its first point: 1/256 of the voxel
        bool seed = false, outvoted = false, grown = false;
    };
    /** Of 8 x 8 x 8 voxels those that were hit, in the order of their numbers. */
    struct Block {
        Voxel first = Voxel::Zero();
        std::array<std::uint64_t, 8> taken{};
        std::vector<Cell> cells;

        std::size_t rankOf(unsigned number) const;
        bool has(unsigned number) const { return taken[number >> 6] >> (number & 63) & 1; }
    };
    /** Calls visit(voxel, cell) for each of a block's. */
    template <typename Visit>
    static void forCells(Block& block, const Visit& visit);
    const Cell* find(const Voxel& voxel) const;
    const Cell* at(const Eigen::Vector3d& point) const;
    Eigen::Vector3f pointOf(const Voxel& voxel, const Cell& cell) const;
    /** Number of voxels around one, and how many of them are dynamic by their own votes. */
    struct Around {
        int all = 0, dynamic = 0;
    };
    Around around(const Voxel& voxel, int reach) const;
    bool isVotedDynamic(const Cell& cell) const;
    bool isOutvoted(const Voxel& voxel) const;
    bool isSurrounded(const Voxel& voxel) const;

    RemovalOptions options_;
    VoxelTable<Block> blocks_;
};
}  // namespace delio::map
