#pragma once
#include <deque>
#include <memory>
#include <vector>

#include "delio/localisation/stored_map.h"
#include "odometry/local_map.h"

namespace delio {
/** What a stored map has about a place, to register scans to: submaps are taken in when they come
 *  near, a few points at a time, and forgotten when they are far. */
class LocalMap {
 public:
    /** Of nothing yet: see load(). */
    explicit LocalMap(std::shared_ptr<const StoredMap> map);

    /** Takes in all that is near `place` (the map's frame). */
    void load(const Eigen::Vector3d& place);
    /** The same, not more than a scan has time for: what comes near on the way is there in time. */
    void follow(const Eigen::Vector3d& place);

    /** Points and planes of what is near, in the map's frame. */
    const ScanToMap& scanToMap() const { return map_; }

 private:
    void comeNear(const Eigen::Vector3d& place);
    void take(Eigen::Index most);

    struct Cloud {
        std::size_t submap = 0;
        Eigen::Matrix3Xf points;  //!< of it
        Eigen::Index taken = 0;
    };
    std::shared_ptr<const StoredMap> stored_;
    std::vector<bool> isNear_;  //!< of each submap: it was taken in, or waits
    std::deque<Cloud> waiting_;
    ScanToMap map_;
};
}  // namespace delio
