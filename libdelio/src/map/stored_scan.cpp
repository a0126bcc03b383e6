#include "stored_scan.h"

#include <cstring>

namespace delio::map {
// The spool holds floats: two ranges in each, and their number in the first.
static_assert(sizeof(float) == 2 * sizeof(std::uint16_t));

io::Spool::Place putAside(const odometry::PackedRanges& view, io::Spool& spool) {
    const auto count = static_cast<std::uint32_t>(view.ranges_cm.size());
    io::Spool::Floats floats(1 + (view.ranges_cm.size() + 1) / 2);
    std::memcpy(floats.data(), &count, sizeof(count));
    if (count > 0)
        std::memcpy(&floats[1], view.ranges_cm.data(), count * sizeof(view.ranges_cm[0]));
    return spool.append(floats);
}

odometry::PackedRanges readView(const StoredScan& scan, const io::Spool& spool) {
    const auto floats = spool.read(scan.view);
    std::uint32_t count = 0;
    std::memcpy(&count, floats.data(), sizeof(count));
    odometry::PackedRanges view{scan.viewFirstRow, std::vector<std::uint16_t>(count)};
    if (count > 0)
        std::memcpy(view.ranges_cm.data(), &floats[1], count * sizeof(view.ranges_cm[0]));
    return view;
}
}  // namespace delio::map
