#include "delio/run/loop_table.h"

#include <fstream>
#include <ostream>

#include "../core/portable_math.h"
#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/files/output_file.h"
#include "formats/table_cells.h"

namespace delio::run {
void writeLoopTable(const std::vector<loops::LoopCandidate>& candidates, const std::string& path) {
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "from_node,to_node,path_m,reach_m,image_share,plane_share,overlap,moved_m,x,y,z,"
               "yaw_deg,accepted,reason\n";
        for (const auto& loop : candidates) {
            const auto& closure = loop.closure;
            const Eigen::Isometry3d& pose = closure.increment.pose;
            const double yaw_deg = portable::atan2(pose(1, 0), pose(0, 0)) * 180 / M_PI;
            out << loop.fromNode << ',' << loop.toNode;
            for (const double value : {loop.path_m, loop.reach_m}) out << ',' << fixed(value, 1);
            for (const double value : {loop.share, closure.share, closure.overlap, loop.moved_m()})
                out << ',' << fixed(value, 3);
            for (const double value : {pose(0, 3), pose(1, 3), pose(2, 3), yaw_deg})
                out << ',' << fixed(value, 4);
            out << ',' << loop.accepted() << ',' << closure.reason << '\n';
        }
    });
}

std::vector<LoopRow> readLoopTable(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    std::string text;
    std::getline(in, text);
    const auto heading = io::cellsOf(text);
    std::size_t columns[4];
    const char* const names[] = {"from_node", "to_node", "accepted", "reason"};
    for (int i = 0; i < 4; ++i) columns[i] = io::columnOf(heading, names[i], path, "loops.csv");
    std::vector<LoopRow> rows;
    for (std::size_t line = 2; std::getline(in, text); ++line) {
        const auto cells = io::cellsOf(text);
        std::size_t values[3] = {};
        for (int i = 0; i < 3; ++i) {
            const auto number =
                numberIn<std::size_t>(columns[i] < cells.size() ? cells[columns[i]] : "");
            if (!number)
                throw Error("'" + path + "', line " + std::to_string(line) + ": '" + names[i] +
                            "' is not a count");
            values[i] = *number;
        }
        const std::string reason = columns[3] < cells.size() ? cells[columns[3]] : "";
        rows.push_back({values[0], values[1], values[2] != 0, reason});
    }
    return rows;
}
}  // namespace delio::run
