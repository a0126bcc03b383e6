#pragma once
#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>

#include "message_source.h"

namespace delio::io {
/** Poses of frames that are fixed to each other: the tree in /tf_static of a bag. */
class StaticTransforms {
 public:
    /** The pose of `child` in `parent`: maps the child's coordinates to the parent's. A leading
     *  slash of a frame's name does not matter. */
    void add(const std::string& parent, const std::string& child, const Eigen::Isometry3d& pose);

    /** Maps coordinates in `frame` to those in `reference`; nothing where they are not connected.
     */
    std::optional<Eigen::Isometry3d> pose(const std::string& frame,
                                          const std::string& reference) const;

    /** The frame's pose in the root of its tree, whose name is put into `root`; nothing where the
     *  links run in a circle. */
    std::optional<Eigen::Isometry3d> poseInRoot(std::string frame, std::string& root) const;

 private:
    struct Link {
        std::string parent;
        Eigen::Isometry3d pose;
    };
    std::map<std::string, Link> links_;  //!< by the child's name
};

/** Those of the bag; none where it has no /tf_static or is damaged before it. */
StaticTransforms transformsOfBag(const OpenSource& open);
}  // namespace delio::io
