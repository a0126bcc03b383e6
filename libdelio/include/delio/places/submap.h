#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <future>
#include <vector>

#include "delio/core/increment.h"
#include "delio/core/stage_options.h"

namespace delio::places {
/** Partition of a drive into submaps. A submap of fewer than 30 000 points has points at half the
 *  spacing: it is of a small place, such as a room. */
struct SubmapOptions : public StageOptions {
    double path = 50;
    double straight = 25;
    double spacing = 0.3;
    double radius = 50;

 protected:
    std::vector<OptionField> fields() const override;
};

/** A path segment of a drive with the odometry's own uncertainty at its end: variances summed over
 * its increments. A pause makes them large. */
struct PathSegment {
    double path_m = 0;         //!< length of the way, metres
    double variance_m2 = 0;    //!< of the place, along its worst axes
    double variance_rad2 = 0;  //!< of the rotation, about its worst axes

    /** The next increment, which moved the vehicle by so many metres. */
    void add(const Increment& increment, double moved_m);
    /** The two segments one after the other. */
    PathSegment operator+(const PathSegment& other) const;
};

/** The segment between the ends of two that have the same start, in either order. */
PathSegment between(const PathSegment& a, const PathSegment& b);

/** Levelled point cloud of a path segment, metres. The origin of its frame is the vehicle at the
 *  key node, and z is up; `level` maps it to the vehicle's frame there. */
struct Submap {
    std::size_t first = 0;  //!< node of the pose graph that it begins with
    std::size_t key = 0;    //!< node whose pose carries it
    std::size_t last = 0;   //!< node that it ends with
    PathSegment driven;     //!< from the drive's first scan to the key node
    Eigen::Matrix3d level =
        Eigen::Matrix3d::Identity();  //!< rotation, this frame to the vehicle's at the key node
    Eigen::Matrix3Xf points;          //!< one in `spacing`, or in half of it: see SubmapOptions
};

/** The level frames of submaps, with these poses of the graph's nodes. */
std::vector<Eigen::Isometry3d> levelFrames(const std::vector<Submap>& submaps,
                                           const std::vector<Eigen::Isometry3d>& poses);

/** Partitions a drive into submaps. A submap ends after a path length of `path`, at a distance of
 *  `straight` from its start (so that small loops close too), or before a time gap. */
class SubmapBuilder {
 public:
    /** Of a drive that begins. */
    explicit SubmapBuilder(const SubmapOptions& options) : options_(options) {}
    const SubmapOptions& options() const { return options_; }  //!< that it was made with

    /** The next scan: increment since the one before, points in the vehicle's frame and the unit
     *  vector that points up in it. Where it begins another submap, the one that ended, otherwise
     *  none (not valid()). Its scans are merged when it is asked for, which takes time. */
    std::future<Submap> add(std::size_t node, const Increment& increment,
                            const Eigen::Matrix3Xf& points, const Eigen::Vector3d& up);

    /** The same of the one that is being made, if any. */
    std::future<Submap> finish();

 private:
    struct Part {
        std::size_t node = 0;
        Eigen::Isometry3d pose;  //!< in the submap's first scan's frame
        Eigen::Matrix3Xf points;
        Eigen::Vector3d up;
        PathSegment driven;  //!< to here
        bool showsMore = true;
    };
    bool isComplete() const;
    /** Where the scan was taken is not known well enough from those before it: a pause. */
    bool isBeyondGap(const Increment& increment) const;
    static Submap merged(const std::vector<Part>& parts, const SubmapOptions& options);
    std::future<Submap> end();

    SubmapOptions options_;
    std::vector<Part> parts_;  //!< of the one that is being made
    PathSegment ended_;        //!< to the last scan of the one before
};
}  // namespace delio::places
