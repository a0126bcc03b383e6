#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "delio/core/stage_options.h"

namespace delio::loops {
struct SubmapOptions : public StageOptions {
    double path = 50;
    double straight = 25;
    double spacing = 0.3;
    double radius = 50;

 protected:
    std::vector<OptionField> fields() const override;
};

/** What was seen along a stretch of a drive, as one levelled cloud. Metres. Its frame has the
 *  origin at the vehicle's at the key node, and z up; `level` maps it to the vehicle's there. */
struct Submap {
    std::size_t first = 0, key = 0, last = 0;  //!< nodes of the pose graph
    double path_m = 0;                         //!< from the drive's first scan to the key node
    Eigen::Matrix3d level = Eigen::Matrix3d::Identity();
    Eigen::Matrix3Xf points;  //!< one in `spacing`
};

/** Its level frame where these poses of the graph's nodes put it. */
Eigen::Isometry3d levelPose(const Submap& submap, const std::vector<Eigen::Isometry3d>& poses);

/** Cuts a drive into submaps: one ends after so much path, or as far from where it began as
 *  `straight`, whichever comes first, so that small loops close, too. */
class SubmapBuilder {
 public:
    explicit SubmapBuilder(const SubmapOptions& options) : options_(options) {}

    /** The next scan: pose (vehicle to anywhere that stays), points in the vehicle's frame and the
     *  unit vector that does in it. */
    void add(std::size_t node, const Eigen::Isometry3d& pose, const Eigen::Matrix3Xf& points,
             const Eigen::Vector3d& up);
    /** Takes back the scan that was added last. */
    void undo() noexcept;

    /** Ends the one that is being made, too. */
    std::vector<Submap> finish();

 private:
    struct Part {
        std::size_t node;
        Eigen::Isometry3d pose;
        Eigen::Matrix3Xf points;
        Eigen::Vector3d up;
        double path_m;  //!< to here
    };
    bool isComplete() const;
    Submap merged() const;

    SubmapOptions options_;
    std::vector<Part> parts_;  //!< of the one that is being made
    std::vector<Submap> submaps_;
    double ended_path_m_ = 0;  //!< of the one before, to its last scan
    Eigen::Vector3d ended_m_ = Eigen::Vector3d::Zero();
};
}  // namespace delio::loops
