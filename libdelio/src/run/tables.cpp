#include "run/tables.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <ostream>
#include <string>
#include <utility>

#include "core/portable_math.h"
#include "delio/core/error.h"
#include "delio/core/text.h"
#include "delio/files/output.h"
#include "delio/run/doubts.h"
#include "formats/table_cells.h"

namespace delio::run {
namespace {
/** Axes that were not observed, each as "x y z". */
std::string axesText(const Eigen::Matrix3Xd& axes) {
    std::string text;
    for (Eigen::Index i = 0; i < axes.cols(); ++i)
        text += (i > 0 ? "; " : "") + fixed(axes(0, i), 3) + ' ' + fixed(axes(1, i), 3) + ' ' +
                fixed(axes(2, i), 3);
    return text;
}

}  // namespace

io::ScanRow scanRowOf(const RunRow& row) {
    io::ScanRow cells{row.scan, row.stamp_s, {}, row.predicted, row.reason};
    const auto put = [&](const std::string& name, const std::string& value) {
        cells.values.emplace_back(name, value);
    };
    put("points", std::to_string(row.points));
    put("not_finite", std::to_string(row.notFinite));
    put("read_ms", fixed(row.read_ms, 3));
    for (const auto& [stage, ms] : row.figures.stages_ms())
        put(std::string(stage) + "_ms", fixed(ms, 3));
    for (const auto& [listener, ms] : row.figures.listeners_ms())
        put(std::string(listener) + "_ms", fixed(ms, 3));
    for (const auto& [name, value] : row.figures.details()) put(name, rounded(value, 9));
    const Quality& quality = row.quality;
    put("matches", std::to_string(quality.matches));
    put("residual_m", rounded(quality.residual_m, 9));
    for (int k = 0; k < 3; ++k)
        put("rotation_observability_" + std::to_string(k + 1),
            rounded(quality.rotationObservability[k], 9));
    for (int k = 0; k < 3; ++k)
        put("translation_observability_" + std::to_string(k + 1),
            rounded(quality.translationObservability[k], 9));
    put("rotation_unobserved", axesText(quality.unobservedRotation));
    put("translation_unobserved", axesText(quality.unobservedTranslation));
    put("searched", row.searched ? "1" : "0");
    put("interrupted", row.interrupted ? "1" : "0");
    put("standing", row.standing ? "1" : "0");
    put("state", stateOf(row));
    return cells;
}

void writeLoopTable(const std::vector<places::LoopCandidate>& candidates, const std::string& path) {
    io::replaceTextFile(path, [&](std::ostream& out) {
        out << "from_node,to_node,path_m,reach_m,image_share,plane_share,overlap,moved_m,x,y,z,"
               "yaw_deg,accepted,reason\n";
        for (const auto& loop : candidates) {
            const auto& closure = loop.closure;
            const Eigen::Isometry3d& pose = closure.increment.pose;
            const double yaw_deg = portable::atan2(pose(1, 0), pose(0, 0)) * 180 / M_PI;
            out << loop.fromNode << ',' << loop.toNode;
            for (const double value : {loop.path_m, loop.reach_m}) out << ',' << fixed(value, 1);
            for (const double value :
                 {loop.imageOverlap, closure.inlierRatio, closure.overlap, loop.moved_m()})
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
                            "' is not a number");
            values[i] = *number;
        }
        const std::string reason = columns[3] < cells.size() ? cells[columns[3]] : "";
        rows.push_back({values[0], values[1], values[2] != 0, reason});
    }
    return rows;
}

namespace {
constexpr std::array<const char*, 3> kNames{"unknown", "in_map", "outside"};  // of Whereabouts
constexpr const char* kAxes[] = {"x", "y", "z", "wx", "wy", "wz"};
}  // namespace

void writeLocalisationTable(const std::vector<RunRow>& rows, const std::vector<MapFix>& fixes,
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
            const RunRow& row = rows[n];
            out << row.scan << ',' << fixed(row.stamp_s, 7) << ','
                << kNames[static_cast<std::size_t>(fix.where)] << ',' << fix.measured << ','
                << fix.searched << ',' << fixed(fix.inlierRatio, 3);
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
                        ": expected a scan number and one of unknown, in_map, outside");
        rows.push_back({*number, static_cast<Whereabouts>(kind), cell(measured) == "1"});
    }
    return rows;
}

namespace fs = std::filesystem;

void RowFiles::File::flush() {
    if (!file) file.reset(std::fopen(path.c_str(), "wb"));
    const bool written =
        file && std::fwrite(pending.data(), 1, pending.size(), file.get()) == pending.size() &&
        std::fflush(file.get()) == 0;
    if (!written) throw Error("cannot write '" + path.string() + "': " + std::strerror(errno));
    pending.clear();
}

RowFiles::RowFiles(fs::path folder) : folder_(std::move(folder)) {
    std::error_code fault;
    fs::remove_all(folder_, fault);
    if (!fault) fs::create_directories(folder_, fault);
    if (fault)
        throw Error("cannot create the folder '" + folder_.string() + "': " + fault.message());
    scans_.path = folder_ / RunFolder::kScans;
    trajectory_.path = folder_ / RunFolder::kOdometry;
}

RowFiles::~RowFiles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void RowFiles::addTo(const RunRow& row, const Eigen::Isometry3d& pose) {
    const auto cells = scanRowOf(row);
    if (!hasHeading_) scans_.pending = scanTableHeading(cells);
    hasHeading_ = true;
    scans_.pending += scanTableLine(cells);
    trajectory_.pending += io::kittiRow(pose);
    const auto now = Clock::now();
    if (now < flushAt_) return;
    scans_.flush();
    trajectory_.flush();
    flushAt_ = now + std::chrono::seconds(1);
}

void RowFiles::add(const RunRow& row, const Eigen::Isometry3d& pose) {
    if (givenUp_) return;
    try {
        addTo(row, pose);
    } catch (...) {
        givenUp_ = true;
        for (File* file : {&scans_, &trajectory_}) {
            file->file.reset();
            std::error_code ignored;
            fs::remove(file->path, ignored);
        }
        throw;
    }
}
}  // namespace delio::run
