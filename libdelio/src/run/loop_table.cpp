#include "delio/run/loop_table.h"

#include <mrpt/core/format.h>

#include <ostream>

#include "delio/io/output_file.h"

namespace delio::run {
void writeLoopTable(const std::vector<loops::LoopCandidate>& candidates, const std::string& path) {
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "from_node,to_node,path_m,reach_m,image_share,plane_share,overlap,moved_m,x,y,z,"
               "yaw_deg,accepted,reason\n";
        for (const auto& loop : candidates) {
            const auto& closure = loop.closure;
            const Eigen::Isometry3d& pose = closure.increment.pose;
            const double yaw_deg = std::atan2(pose(1, 0), pose(0, 0)) * 180 / M_PI;
            out << loop.fromNode << ',' << loop.toNode
                << mrpt::format(",%.1f,%.1f,%.3f,%.3f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,", loop.path_m,
                                loop.reach_m, loop.share, closure.share, closure.overlap,
                                loop.moved_m, pose(0, 3), pose(1, 3), pose(2, 3), yaw_deg)
                << loop.accepted() << ',' << closure.reason << '\n';
        }
    });
}
}  // namespace delio::run
