#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "delio/core/increment.h"
#include "delio/core/stage_options.h"

namespace delio::places {
/** Which pairs of submaps are compared, and which loops are accepted. */
struct LoopOptions : public StageOptions {
    bool enabled = true;
    double min_path = 50;
    double drift = 0.005;
    double rival = 0.8;
    double reach = 30;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Verification of a pair of submaps. */
struct ClosureOptions : public StageOptions {
    double min_overlap = 0.3;
    double agreed = 0.2;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Result of the registration of two submaps. */
struct Closure {
    Eigen::Isometry3d level = Eigen::Isometry3d::Identity();  //!< `to` to `from`, level frames
    Increment increment;  //!< `to` to `from`, the vehicle's frames at the key nodes
    double overlap = 0;   //!< overlap coefficient of the voxels above the ground, 0 to 1
    /** Of the points in voxels with a plane, the fraction that lies on it. */
    double inlierRatio = 0;
    std::string reason;  //!< reason of the rejection; empty: accepted
};

/** Candidate pair of submaps, and the result of its verification. */
struct LoopCandidate {
    std::size_t from = 0;                                        //!< the earlier submap
    std::size_t to = 0;                                          //!< the later one
    std::size_t fromNode = 0;                                    //!< key node of `from`
    std::size_t toNode = 0;                                      //!< key node of `to`
    double path_m = 0;                                           //!< driven between
    double reach_m = 0;                                          //!< search radius about `expected`
    Eigen::Isometry3d expected = Eigen::Isometry3d::Identity();  //!< `to` to `from`, level frames
    double imageOverlap = 0;                                     //!< of the height images
    Closure closure;  //!< with the reason why it was not accepted
    bool accepted() const { return closure.reason.empty(); }  //!< both are one place
    double moved_m() const;  //!< distance between the found and the expected position
};
}  // namespace delio::places
