#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../io/spool.h"
#include "delio/loops/grounds.h"
#include "delio/loops/sketch.h"

namespace delio::loops {
/** The submaps of a drive, by number: their sketches in memory, their points on the disk, and of
 *  those that were needed last what others are verified against. */
class Places {
 public:
    /** `folder`: of the file of points, see Spool. */
    explicit Places(std::string folder) : folder_(std::move(folder)) {}

    /** The next submap's points. Error where there is no room for them. */
    void add(const Eigen::Matrix3Xf& points);

    const Sketch& sketch(std::size_t submap) const { return sketches_[submap]; }
    /** From the disk. */
    Eigen::Matrix3Xf points(std::size_t submap) const;
    /** By how much it looks most like itself elsewhere, within `reach` metres. */
    const std::vector<Shift>& repetitions(std::size_t submap, double reach);
    std::shared_ptr<const Ground> ground(std::size_t submap);

 private:
    std::string folder_;
    std::optional<io::Spool> spool_;  //!< made with the first submap
    std::vector<io::Spool::Place> points_;
    std::vector<Sketch> sketches_;
    std::vector<std::vector<Shift>> repetitions_;  //!< empty: not known yet
    Grounds grounds_{5};  //!< a submap and those it is compared with, next to each other
};
}  // namespace delio::loops
