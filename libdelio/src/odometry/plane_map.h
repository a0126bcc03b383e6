#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/chunked.h"
#include "core/voxel_table.h"
#include "delio/core/odometry_options.h"

namespace delio::odometry {
/** The surface in one voxel. Metres, the map's frame. */
struct Plane {
    Eigen::Vector3d mean;   //!< of the points
    Eigen::Matrix3d axes;   //!< columns: the normal, of either sign, then the shorter one inside
    double variance;        //!< of the points, along the normal
    double count;           //!< of points
    Eigen::Vector2d tilts;  //!< variances of the normal's direction, rad^2, along the other axes

    Eigen::Vector3d normal() const { return axes.col(0); }  //!< unit, of either sign
    /** A point seen from the mean, along the axes: the first one is its distance, signed. */
    Eigen::Vector3d along(const Eigen::Vector3d& point) const {
        return axes.transpose() * (point - mean);
    }
    /** Variance of the distance between the plane and a point of its surface that is `along` its
     *  axes: the surface's own thickness, and how well mean and normal are known there. */
    double varianceAt(const Eigen::Vector3d& along) const {
        return variance + variance / count + tilts[0] * along[1] * along[1] +
               tilts[1] * along[2] * along[2];
    }
    /** Variance of the normal's direction where it is known worse, rad^2. */
    double tilt() const { return tilts[0]; }
    /** Variance along the normal, as a share of that along the shorter axis inside. */
    double flatness() const { return tilts[0] * count; }
};

/** What the last scans saw, as one plane a voxel, with running mean and scatter; on several levels,
 *  each of voxels twice as large as the one before. The largest hold level planes only: the ground
 *  between a few rings that lie metres apart. (Whatever else is flat over metres, give or take
 *  10 cm, is mostly a row of bushes.) Memory is bounded by `radius`. */
class PlaneMap {
 public:
    /** `up`: the unit vector that does, in the map's frame. */
    explicit PlaneMap(const PlaneMapOptions& options,
                      const Eigen::Vector3d& up = Eigen::Vector3d::UnitZ());

    /** Takes points (metres, the map's frame) in. A voxel that has `max_points` stays as it is: it
     *  is what drift is held against. */
    void add(const Eigen::Matrix3Xd& points);

    /** Fits the planes that the latest add() has changed, before at() asks for them. */
    void fitLatest() const;

    /** Drops the planes at `points` (likewise), which are dynamic. Planes of the largest levels,
     *  which are the ground's, stay. */
    void erase(const Eigen::Matrix3Xd& points);

    /** Drops what lies farther than `radius` from `centre`. */
    void forgetFarFrom(const Eigen::Vector3d& centre);

    /** The plane of the smallest voxel about `point` that has one, or none. Valid until the map
     *  changes. */
    const Plane* at(const Eigen::Vector3d& point) const { return inVoxel(voxelAt(point)); }

    /** Which of the smallest voxels a point is in, and what at() gives for all points in it. */
    std::uint64_t voxelAt(const Eigen::Vector3d& point) const;
    /** See voxelAt(). */
    const Plane* inVoxel(std::uint64_t voxel) const { return planeIn(voxel, cellsAbout(voxel)); }

    // inVoxel() of many voxels, step by step, so that their memory accesses overlap: each step
    // prefetches what the next one needs.
    /** Cells of the finest levels; VoxelIndex::kNone where one is missing. */
    using Cells = std::array<std::uint32_t, 2>;
    void prefetch(std::uint64_t voxel) const;      //!< for cellsAbout()
    Cells cellsAbout(std::uint64_t voxel) const;   //!< that the voxel is a part of
    void prefetchPlane(const Cells& cells) const;  //!< for planeIn()
    const Plane* planeIn(std::uint64_t voxel, const Cells& cells) const;  //!< of inVoxel()

    /** Drops everything, for a map in which `up` is up. */
    void clear(const Eigen::Vector3d& up);

    /** How many there are, on all levels. */
    std::size_t voxels() const;
    /** How many of them hold a plane. */
    std::size_t planes() const;

 private:
    /** Of the points in a voxel. */
    struct Sums {
        //! The first point: sums are taken from there.
        Eigen::Vector3d origin = Eigen::Vector3d::Zero();
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        /** xx, yy, zz, xy, yz, zx. */
        Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();
        unsigned count = 0;

        void add(const Eigen::Vector3d& point);
        void add(const Sums& other);
        void clear();
        Eigen::Matrix3d scatter() const;
    };
    /** What comes into the map at once. */
    struct Batch {
        std::vector<std::uint64_t> voxels;  //!< the smallest ones
        std::vector<Sums> sums;             //!< of the points in each of them
    };
    /** Whether there is a plane in a cell. */
    enum class State : std::uint8_t { None, Plane, Unknown, BeingFitted };
    /** Many threads may ask at once. */
    struct SharedState : public std::atomic<State> {
        SharedState(State state = State::None) : std::atomic<State>(state) {}
        SharedState(const SharedState& other) : std::atomic<State>(other.load()) {}
        SharedState& operator=(const SharedState& other) {
            store(other.load());
            return *this;
        }
    };
    /** Voxels of one size. Planes are fitted where they are asked for: of most voxels that get a
     *  point they are not before it gets the next one. What is asked most, whether there is one,
     *  lies closely packed. */
    struct Level {
        unsigned number;
        double edge;      //!< of its voxels, metres
        double steepest;  //!< least that its planes' normals look up, cosine
        VoxelTable<Sums> cells;
        mutable std::vector<SharedState> states;  //!< of the cells
        mutable Chunked<Plane> planes;            //!< likewise
        std::vector<std::uint32_t> latest;        //!< cells that the latest add() has changed

        void clear();
        void forgetPlanes();
    };
    Batch batchOf(const Eigen::Matrix3Xd& points) const;
    void add(const Batch& batch, Level& level) const;
    State fit(const Level& level, std::uint32_t number) const;
    const Plane* planeIn(const Level& level, std::uint32_t number) const;
    /** How many levels Cells are of: larger voxels are few. */
    std::size_t finest() const { return std::min(levels_.size(), Cells().size()); }

    PlaneMapOptions options_;
    Eigen::Vector3d up_;
    std::vector<Level> levels_;  //!< the finest first
};
}  // namespace delio::odometry
