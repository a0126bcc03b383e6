#include "delio/run/localisation_table.h"

#include <array>
#include <fstream>
#include <ostream>

#include "delio/core/error.h"
#include "delio/core/numbers.h"
#include "delio/files/output_file.h"
#include "formats/table_cells.h"

namespace delio::run {
namespace {
constexpr std::array<const char*, 3> kNames{"unknown", "in_map", "outside"};  // of Whereabouts
constexpr const char* kAxes[] = {"x", "y", "z", "wx", "wy", "wz"};
}  // namespace

void writeLocalisationTable(const RunRows& rows, const std::vector<MapFix>& fixes,
                            const std::string& path) {
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "scan,stamp_s,where,measured,searched,share,x,y,z,qx,qy,qz,qw";
        for (int i = 0; i < 6; ++i)
            for (int k = i; k < 6; ++k) out << ",cov_" << kAxes[i] << '_' << kAxes[k];
        out << ",reason\n";
        for (std::size_t n = 0; n < fixes.size(); ++n) {
            const auto& fix = fixes[n];
            const auto& pose = fix.vehicle.pose;
            const Eigen::Quaterniond q(pose.linear());
            const RunRow row = rows[n];
            out << row.scan << ',' << fixed(row.stamp_s, 7) << ','
                << kNames[static_cast<std::size_t>(fix.where)] << ',' << fix.measured << ','
                << fix.searched << ',' << fixed(fix.share, 3);
            const bool known = fix.where != Whereabouts::kUnknown;
            for (const double value :
                 {pose(0, 3), pose(1, 3), pose(2, 3), q.x(), q.y(), q.z(), q.w()})
                out << ',' << (known ? rounded(value, 9) : "");
            for (int i = 0; i < 6; ++i)
                for (int k = i; k < 6; ++k)
                    out << ',' << (known ? rounded(fix.vehicle.covariance(i, k), 6) : "");
            out << ',' << fix.reason << '\n';
        }
    });
}

std::vector<LocalisationRow> readLocalisationTable(const std::string& path) {
    std::ifstream in(path);
    if (!in) throw Error("cannot read '" + path + "': no such file, or not readable");
    std::string text;
    std::getline(in, text);
    const auto heading = io::cellsOf(text);
    const auto column = [&](const char* name) {
        return io::columnOf(heading, name, path, "localisation.csv");
    };
    const std::size_t scan = column("scan"), where = column("where"), measured = column("measured");
    std::vector<LocalisationRow> rows;
    for (std::size_t line = 2; std::getline(in, text); ++line) {
        const auto cells = io::cellsOf(text);
        const auto cell = [&](std::size_t i) { return i < cells.size() ? cells[i] : ""; };
        const auto number = numberIn<std::size_t>(cell(scan));
        std::size_t kind = 0;
        while (kind < kNames.size() && cell(where) != kNames[kind]) ++kind;
        if (!number || kind == kNames.size())
            throw Error("'" + path + "', line " + std::to_string(line) +
                        ": no scan, or none of unknown, in_map and outside");
        rows.push_back({*number, static_cast<Whereabouts>(kind), cell(measured) == "1"});
    }
    return rows;
}
}  // namespace delio::run
