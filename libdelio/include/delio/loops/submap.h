#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "delio/core/increment.h"
#include "delio/core/stage_options.h"

namespace delio::loops {
/** Where a drive is cut, and what is kept of it. */
struct SubmapOptions : public StageOptions {
    double path = 50;
    double straight = 25;
    double spacing = 0.3;
    double radius = 50;

 protected:
    std::vector<OptionField> fields() const override;
};

/** So much of a drive, and by how much the odometry itself says that it may be off at its end:
 *  variances of place and rotation, summed up over its increments. A pause makes them large. */
struct Stretch {
    double path_m = 0;         //!< length of the way, metres
    double variance_m2 = 0;    //!< of the place, along its worst axes
    double variance_rad2 = 0;  //!< of the rotation, about its worst axes

    /** The next increment, which moved the vehicle by so many metres. */
    void add(const Increment& increment, double moved_m);
    /** One after the other. */
    Stretch operator+(const Stretch& other) const;
};

/** What was driven in between, whichever came first. */
Stretch between(const Stretch& a, const Stretch& b);

/** What was seen along a stretch of a drive, as one levelled cloud. Metres. Its frame has the
 *  origin at the vehicle's at the key node, and z up; `level` maps it to the vehicle's there. */
struct Submap {
    std::size_t first = 0;  //!< node of the pose graph that it begins with
    std::size_t key = 0;    //!< node whose pose carries it
    std::size_t last = 0;   //!< node that it ends with
    Stretch driven;         //!< from the drive's first scan to the key node
    Eigen::Matrix3d level =
        Eigen::Matrix3d::Identity();  //!< rotation, this frame to the vehicle's at the key node
    Eigen::Matrix3Xf points;          //!< one in `spacing`
};

/** The level frames of submaps, with these poses of the graph's nodes. */
std::vector<Eigen::Isometry3d> levelFrames(const std::vector<Submap>& submaps,
                                           const std::vector<Eigen::Isometry3d>& poses);

/** Cuts a drive into submaps: one ends after so much path, or as far from where it began as
 *  `straight`, whichever comes first, so that small loops close, too; and before a gap. */
class SubmapBuilder {
 public:
    /** Of a drive that begins. */
    explicit SubmapBuilder(const SubmapOptions& options) : options_(options) {}
    const SubmapOptions& options() const { return options_; }  //!< that it was made with

    /** The next scan: increment since the one before, points in the vehicle's frame and the unit
     *  vector that points up in it. Where it begins another submap, the one that ended. */
    std::optional<Submap> add(std::size_t node, const Increment& increment,
                              const Eigen::Matrix3Xf& points, const Eigen::Vector3d& up);

    /** The one that is being made, if any. */
    std::optional<Submap> finish();

 private:
    struct Part {
        std::size_t node = 0;
        Eigen::Isometry3d pose;  //!< in the submap's first scan's frame
        Eigen::Matrix3Xf points;
        Eigen::Vector3d up;
        Stretch driven;  //!< to here
        bool showsMore = true;
    };
    bool isComplete() const;
    /** Where the scan was taken is not known well enough from those before it: a pause. */
    bool isBeyondGap(const Increment& increment) const;
    Submap merged() const;

    SubmapOptions options_;
    std::vector<Part> parts_;  //!< of the one that is being made
    Stretch ended_;            //!< to the last scan of the one before
};
}  // namespace delio::loops
