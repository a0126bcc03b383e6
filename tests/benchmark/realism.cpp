// benchmark_realism: what can be counted in the scans of several drives, side by side: how close
// are synthetic drives to real ones? Prints a Markdown table. Needs OUT.poses.txt and
// OUT.calib.txt beside each rawlog.
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/rawlog_reader.h"
#include "drive_measures.h"

namespace {
using namespace delio;
using Rows = std::vector<std::pair<std::string, std::string>>;

constexpr std::size_t kMostScans = 12;

/** Of some scans spread over the drive, each with the one after it. */
Rows measure(const std::string& rawlog) {
    const auto cam0 = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    const std::size_t stride = std::max<std::size_t>(1, (cam0.size() - 1) / kMostScans);
    io::RawlogReader reader(rawlog);
    benchmark::DriveMeasures measures;
    std::optional<Scan> before;
    while (auto scan = reader.next()) {
        const std::size_t i = scan->index;
        if (i >= cam0.size()) break;
        if (before && i % stride == 1 % stride && !before->points->empty() &&
            !scan->points->empty()) {
            const Eigen::Isometry3d motion = Tr.inverse() * cam0[i - 1].inverse() * cam0[i] * Tr;
            measures.add(*scan);
            measures.addPair(*before, *scan, motion);
        }
        before = std::move(scan);
    }
    return measures.rows();
}

std::string nameOf(const std::string& path) {
    const auto begin = path.find_last_of('/') + 1;
    return path.substr(begin, path.find_last_of('.') - begin);
}

void print(const std::vector<std::string>& names, const std::vector<Rows>& drives) {
    std::string head = "| |", line = "|---|";
    for (const auto& name : names) {
        head += " " + name + " |";
        line += "---|";
    }
    std::printf("%s\n%s\n", head.c_str(), line.c_str());
    for (std::size_t row = 0; row < drives[0].size(); ++row) {
        std::string text = "| " + drives[0][row].first + " |";
        for (const auto& drive : drives) text += " " + drive[row].second + " |";
        std::printf("%s\n", text.c_str());
    }
}
}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: benchmark_realism DRIVE.rawlog...\n");
        return 2;
    }
    try {
        const std::vector<std::string> paths(argv + 1, argv + argc);
        std::vector<std::string> names;
        std::vector<Rows> drives;
        for (const auto& path : paths) {
            names.push_back(nameOf(path));
            drives.push_back(measure(path));
        }
        print(names, drives);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "benchmark_realism: %s\n", plainMessage(e).c_str());
        return 1;
    }
    return 0;
}
