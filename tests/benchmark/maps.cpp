// Maps against the labels of synth2rawlog --labels: benchmark_maps [--set section.key=value]
// DRIVE.rawlog... By voxels of 0.2 m of all points within the map's ranges, at the run's own poses:
// those with a static point that are in the map, and those of dynamic points alone that are not.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <unordered_map>

#include "delio/core/error.h"
#include "delio/formats/drive_meta.h"
#include "delio/recordings/rawlog_reader.h"
#include "delio/run/run.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

std::uint64_t voxelOf(const Eigen::Vector3d& p) {
    constexpr double kSize_m = 0.2;
    const auto part = [](double v) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v / kSize_m))) &
               ((1U << 21) - 1);
    };
    return part(p.x()) << 42 | part(p.y()) << 21 | part(p.z());
}

std::vector<char> labelsOf(const std::string& rawlog, std::size_t scan) {
    char name[32];
    std::snprintf(name, sizeof(name), "%06zu.label", scan);
    std::ifstream in(fs::path(io::sidecarPath(rawlog, "_Images")) / name, std::ios::binary);
    if (!in) throw Error("'" + rawlog + "' has no labels: make it with synth2rawlog --labels");
    return {std::istreambuf_iterator<char>(in), {}};
}

/** What is known of a voxel, of the points within the map's ranges. */
struct Truth {
    bool isStatic = false;    //!< a point that stands is in it
    bool isLabelled = false;  //!< all its points were told to move while the drive went on
};
using Voxels = std::unordered_map<std::uint64_t, Truth>;

/** Keeps what is needed to hold the map against: scans at their final poses. */
class Labels : public SlamListener {
 public:
    Labels(std::string rawlog, const map::MapOptions& options)
        : rawlog_(std::move(rawlog)), options_(options) {}

    const char* name() const override { return "labels"; }
    void add(const SlamScan& scan) override {
        auto& used = scans_.emplace_back();
        if (scan.step.predicted) return;
        const auto labels = labelsOf(rawlog_, scan.scan.index);
        const auto& points = scan.step.used.points;
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const auto k = static_cast<std::size_t>(i);
            const double range = points.col(i).cast<double>().norm();
            if (range < options_.minRange_m || range > options_.maxRange_m) continue;
            const bool told = !scan.step.used.dynamic.empty() && scan.step.used.dynamic[k] != 0;
            used.push_back({scan.scan.sensorPose.cast<float>() * points.col(i),
                            labels.at(scan.step.used.indices[k]) != 0, told});
        }
    }

    Voxels voxels(const std::vector<Eigen::Isometry3d>& poses) const {
        Voxels voxels;
        for (std::size_t i = 0; i < scans_.size(); ++i)
            for (const auto& point : scans_[i]) {
                auto& truth = voxels
                                  .try_emplace(voxelOf(poses[i] * point.position.cast<double>()),
                                               Truth{false, true})
                                  .first->second;
                truth.isStatic = truth.isStatic || !point.moves;
                truth.isLabelled = truth.isLabelled && point.told;
            }
        return voxels;
    }

 private:
    struct Point {
        Eigen::Vector3f position;
        bool moves, told;
    };
    std::string rawlog_;
    map::MapOptions options_;
    std::vector<std::vector<Point>> scans_;
};

struct Shares {
    double preserved = 0, removed = 0;  //!< percent
};

/** `isKept`: whether the map has something in a voxel. */
template <typename Kept>
Shares sharesOf(const Voxels& voxels, const Kept& isKept) {
    std::size_t still = 0, preserved = 0, moving = 0, removed = 0;
    for (const auto& [key, truth] : voxels) {
        const bool kept = isKept(key, truth);
        (truth.isStatic ? still : moving) += 1;
        preserved += truth.isStatic && kept;
        removed += !truth.isStatic && !kept;
    }
    const auto percent = [](std::size_t part, std::size_t all) {
        return 100.0 * static_cast<double>(part) /
               static_cast<double>(std::max<std::size_t>(all, 1));
    };
    return {percent(preserved, still), percent(removed, moving)};
}

void measure(const std::string& rawlog, const std::vector<std::string>& settings) {
    Options options = Options::forDrive("accurate", io::readDriveMeta(rawlog));
    for (const auto& assignment : settings) options.set(assignment);
    options.check();
    run::RunSettings runSettings;
    run::Run run(options, runSettings);
    const auto labels = std::make_shared<Labels>(rawlog, options.map);
    run.attach(labels);
    io::RawlogReader reader(rawlog);
    while (const auto scan = reader.next()) run.process(*scan);
    run.finish(true);
    const auto& poses = run.record().final.poses;
    const auto start = std::chrono::steady_clock::now();
    const auto map = run.maps().points->build(poses);
    const std::chrono::duration<double, std::milli> all_ms =
        std::chrono::steady_clock::now() - start;

    std::unordered_map<std::uint64_t, bool> kept;
    for (const auto& point : map.points) kept[voxelOf(point.position.cast<double>())] = true;
    const auto voxels = labels->voxels(poses);
    const auto before =
        sharesOf(voxels, [](std::uint64_t, const Truth& truth) { return !truth.isLabelled; });
    const auto after =
        sharesOf(voxels, [&](std::uint64_t key, const Truth&) { return kept.count(key) > 0; });
    const auto scans = static_cast<double>(poses.size());
    std::printf("%-28s  %7.2f / %6.2f  %7.2f / %6.2f  %8.1f  %8.1f\n",
                fs::path(rawlog).filename().string().c_str(), before.preserved, before.removed,
                after.preserved, after.removed, map.removal_ms / scans, all_ms.count() / scans);
}
}  // namespace

int main(int argc, char** argv) try {
    TCLAP::CmdLine cmd("benchmark_maps: dynamic objects taken out of maps, against labels");
    TCLAP::MultiArg<std::string> set("", "set", "One option; may be repeated", false,
                                     "section.key=value", cmd);
    TCLAP::UnlabeledMultiArg<std::string> rawlogs("rawlogs", "Drives with labels", true,
                                                  "DRIVE.rawlog", cmd);
    cmd.parse(argc, argv);
    std::printf(
        "static preserved / dynamic removed, %% of voxels; ms a scan\n%-28s  %-16s  %-16s  %8s  "
        "%8s\n",
        "", "by the odometry", "by the drive", "removal", "all");
    for (const auto& rawlog : rawlogs.getValue()) measure(rawlog, set.getValue());
    return 0;
} catch (const std::exception& e) {
    std::cerr << plainMessage(e) << "\n";
    return 1;
}
