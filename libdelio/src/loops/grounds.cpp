#include "delio/loops/grounds.h"

#include <algorithm>

namespace delio::loops {
std::shared_ptr<const Ground> Grounds::at(std::size_t submap, const std::function<Ground()>& make) {
    const auto known = std::find_if(recent_.begin(), recent_.end(),
                                    [&](const Recent& other) { return other.submap == submap; });
    Recent recent{submap, nullptr};
    if (known != recent_.end()) {
        recent = *known;
        recent_.erase(known);
    } else {
        recent.ground = std::make_shared<Ground>(make());
    }
    recent_.push_front(recent);
    if (recent_.size() > most_) recent_.pop_back();
    return recent.ground;
}
}  // namespace delio::loops
