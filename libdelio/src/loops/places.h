#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delio/loops/grounds.h"
#include "delio/loops/sketch.h"
#include "files/spool.h"

namespace delio::loops {
/** The submaps of a drive, by number: their sketches in memory, their points on the disk, and of
 *  those that were needed last what others are verified against. */
class Places {
 public:
    /** `isKept`: the points' file has a name, and stays. */
    Places(std::string folder, bool isKept) : folder_(std::move(folder)), isKept_(isKept) {}

    /** The next submap's points. Error where there is no room for them. */
    void add(const Eigen::Matrix3Xf& points);

    const Sketch& sketch(std::size_t submap) const { return sketches_[submap]; }
    /** From the disk. */
    Eigen::Matrix3Xf points(std::size_t submap) const;
    /** By how much it looks most like itself elsewhere, within `reach` metres. */
    const std::vector<Shift>& repetitions(std::size_t submap, double reach);
    std::shared_ptr<const Ground> ground(std::size_t submap);

    /** What has to be kept to go on later, see core/checkpoint.h: where the points lie. The rest is
     *  made of these. */
    template <class Archive>
    void serialize(Archive& archive) {
        std::uint64_t end = spool_ ? spool_->kept() : 0;
        archive(points_, end);
        if constexpr (Archive::is_loading::value) reopen(end);
    }

 private:
    std::string path() const { return folder_ + "/submaps.spool"; }
    void reopen(std::uint64_t end);

    std::string folder_;
    bool isKept_;
    std::optional<io::Spool> spool_;  //!< made with the first submap
    std::vector<io::Spool::Place> points_;
    std::vector<Sketch> sketches_;
    std::vector<std::vector<Shift>> repetitions_;  //!< empty: not known yet
    Grounds grounds_{5};  //!< a submap and those it is compared with, next to each other
};
}  // namespace delio::loops
