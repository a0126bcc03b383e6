// Which of several trajectories of one drive is better, without a reference to ask: how thin the
// map is that they make, how near points that were not used lie to it, and whether the drive comes
// out the same backwards and with every second scan. DeLiO is run here; other programs' poses are
// read.
//   benchmark_self_consistency [--profile NAME] [--set section.key=value]... [--spacing M]
//       [--reference] DRIVE.rawlog
//       [NAME=POSES.txt[,BACKWARDS.txt[,SECOND.txt[,SECOND_BACKWARDS.txt]]]]...
// Poses are the sensor's, a row a scan used, in the order in which the scans were used. With
// --reference, DRIVE.poses.txt (and .calib.txt) beside the rawlog is one of the trajectories.
#include <mrpt/maps/CSimplePointsMap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/odometry/odometry.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/options.h"
#include "map_measures.h"
#include "odometry/preprocess.h"

namespace {
using namespace delio;

/** One program's poses; `back` and the others may be missing. */
struct Entry {
    std::string name;
    Poses all, back, second, secondBack;  //!< by scan, also where the drive was run backwards
    Poses heldOut;                        //!< from the used half of the points; else `all`
};

std::vector<Scan> readScans(const std::string& rawlog) {
    const auto reader = io::openScans(rawlog);
    std::vector<Scan> scans;
    while (auto scan = reader->next()) scans.push_back(std::move(*scan));
    return scans;
}

/** The points whose number is even, or odd. */
Scan half(const Scan& scan, std::size_t parity) {
    Scan result = scan;
    result.rings.clear();
    result.times_s.clear();
    result.points = mrpt::maps::CSimplePointsMap::Create();
    const auto& x = scan.points->getPointsBufferRef_x();
    const auto& y = scan.points->getPointsBufferRef_y();
    const auto& z = scan.points->getPointsBufferRef_z();
    for (std::size_t i = parity; i < x.size(); i += 2) {
        result.points->insertPointFast(x[i], y[i], z[i]);
        if (!scan.rings.empty()) result.rings.push_back(scan.rings[i]);
        if (!scan.times_s.empty()) result.times_s.push_back(scan.times_s[i]);
    }
    return result;
}

/** DeLiO's poses of every `every`-th scan, by scan; run from the last to the first if `backwards`.
 */
Poses run(const std::vector<Scan>& scans, std::size_t every, bool backwards,
          const OdometryOptions& options) {
    std::vector<Scan> order;
    for (std::size_t i = 0; i < scans.size(); i += every) order.push_back(scans[i]);
    if (backwards) {
        std::reverse(order.begin(), order.end());
        const double last = order.front().stamp_s;
        for (auto& scan : order) {
            scan.stamp_s = last - scan.stamp_s;
            for (auto& time : scan.times_s) time = -time;
        }
    }
    const auto odometry = makeOdometry(options);
    Poses poses;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (const auto& scan : order) {
        pose = pose * odometry->process(scan).increment.pose;
        poses.push_back(pose);
    }
    if (backwards) std::reverse(poses.begin(), poses.end());
    return poses;
}

Poses everySecond(const Poses& poses) {
    Poses result;
    for (std::size_t i = 0; i < poses.size(); i += 2) result.push_back(poses[i]);
    return result;
}

Entry readEntry(const std::string& argument, std::size_t scans) {
    const auto equals = argument.find('=');
    if (equals == argument.npos)
        throw Error("'" + argument + "' is not of the form NAME=POSES.txt");
    Entry entry;
    entry.name = argument.substr(0, equals);
    const std::vector<Poses*> kinds = {&entry.all, &entry.back, &entry.second, &entry.secondBack};
    std::size_t from = equals + 1;
    for (std::size_t k = 0; k < kinds.size() && from <= argument.size(); ++k) {
        const auto comma = std::min(argument.find(',', from), argument.size());
        const std::string file = argument.substr(from, comma - from);
        *kinds[k] = io::readTrajectory(file).poses;
        const std::size_t expected = k < 2 ? scans : (scans + 1) / 2;
        if (kinds[k]->size() != expected)
            throw Error(file + " has " + std::to_string(kinds[k]->size()) + " poses instead of " +
                        std::to_string(expected));
        if (k % 2 == 1) std::reverse(kinds[k]->begin(), kinds[k]->end());
        from = comma + 1;
    }
    entry.heldOut = entry.all;
    return entry;
}

/** Prints median and 90 % of each entry's distances, over the points that are on a plane with all
 *  entries: an entry that smears planes until they are none gains nothing by it. */
void printDistances(const char* what, const std::vector<Entry>& entries,
                    const std::vector<Distances>& distances) {
    std::vector<std::size_t> common;
    for (std::size_t i = 0; i < distances[0].size(); ++i)
        if (std::all_of(distances.begin(), distances.end(),
                        [&](const Distances& d) { return std::isfinite(d[i]); }))
            common.push_back(i);
    std::printf("%s, of %zu points on planes\n", what, common.size());
    double first[2] = {0, 0};
    for (std::size_t e = 0; e < entries.size(); ++e) {
        std::vector<double> sorted;
        sorted.reserve(common.size());
        for (const auto i : common) sorted.push_back(distances[e][i]);
        std::sort(sorted.begin(), sorted.end());
        const double figures[2] = {sorted[sorted.size() / 2], sorted[sorted.size() * 9 / 10]};
        if (e == 0) std::copy(figures, figures + 2, first);
        const auto planar = std::count_if(distances[e].begin(), distances[e].end(),
                                          [](double d) { return std::isfinite(d); });
        std::printf("  %-14s median %6.2f mm   90 %% %6.2f mm", entries[e].name.c_str(),
                    1e3 * figures[0], 1e3 * figures[1]);
        if (e > 0)
            std::printf("   %s: %+.1f %%, %+.1f %%", entries[0].name.c_str(),
                        100 * (first[0] / figures[0] - 1), 100 * (first[1] / figures[1] - 1));
        std::printf("   (planar: %.1f %%)\n",
                    100 * static_cast<double>(planar) / static_cast<double>(distances[e].size()));
    }
}

/** Disagreement of two trajectories of the same scans: of their steps, and of their poses where
 * they are laid over each other at the first scan. */
void printAgreement(const std::string& name, const char* what, const Poses& a, const Poses& b) {
    if (a.empty() || b.empty()) return;
    const auto steps = evaluation::relativeError(a, b);
    std::vector<double> metres, degrees;
    for (std::size_t i = 1; i < a.size(); ++i) {
        const Eigen::Isometry3d own = a[0].inverse() * a[i];
        const Eigen::Isometry3d off = own.inverse() * (b[0].inverse() * b[i]);
        metres.push_back(off.translation().norm());
        degrees.push_back(evaluation::rotationAngle_rad(off) * 180 / M_PI);
    }
    const auto m = evaluation::spreadOf(metres), deg = evaluation::spreadOf(degrees);
    const auto worst = [](const std::vector<double>& errors) {
        return std::max_element(errors.begin(), errors.end()) - errors.begin();
    };
    std::printf(
        "  %-14s %-30s steps %.4f / %.4f m (%td), %.4f / %.4f deg (%td)   poses %.4f / %.4f m, "
        "%.4f / %.4f deg\n",
        name.c_str(), what, steps.translation_m.median, steps.translation_m.max,
        worst(steps.translations_m), steps.rotation_deg.median, steps.rotation_deg.max,
        worst(steps.rotations_deg), m.median, m.max, deg.median, deg.max);
}

void measure(const std::string& rawlog, Options options, const std::vector<std::string>& arguments,
             double spacing, bool withReference) {
    const auto meta = io::readDriveMeta(rawlog);
    if (meta)
        for (auto* scan : {&options.planes.scan, &options.paper.scan})
            scan->vertical_correction_deg = meta->verticalCorrectionDeg;
    const auto scans = readScans(rawlog);
    if (scans.size() < 3) throw Error(rawlog + ": three scans are needed at least");

    std::vector<SplitScan> split;
    std::vector<Scan> usedHalves;
    for (const auto& scan : scans) {
        usedHalves.push_back(half(scan, 0));
        split.push_back({odometry::preprocess(usedHalves.back(), options.scan()).points,
                         odometry::preprocess(half(scan, 1), options.scan()).points});
    }
    Entry delio;
    delio.name = "DeLiO";
    delio.all = run(scans, 1, false, options);
    delio.back = run(scans, 1, true, options);
    delio.second = run(scans, 2, false, options);
    delio.secondBack = run(scans, 2, true, options);
    delio.heldOut = run(usedHalves, 1, false, options);
    std::vector<Entry> entries = {delio};
    for (const auto& argument : arguments) entries.push_back(readEntry(argument, scans.size()));
    if (withReference) {
        const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
        Entry reference;
        reference.name = "reference";
        reference.all =
            io::lidarToCam0(io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")), Tr.inverse())
                .poses;
        reference.heldOut = reference.all;
        if (reference.all.size() != scans.size())
            throw Error(rawlog + " and its .poses.txt do not have the same number of scans");
        entries.push_back(reference);
    }

    const MapPoints map = mapPoints(split, delio.all, spacing);
    const MapPoints queries = heldOutPoints(split, spacing);
    std::vector<Distances> thickness, residuals;
    for (const auto& entry : entries) {
        thickness.push_back(mapThickness(map, entry.all));
        residuals.push_back(heldOutResiduals(map, queries, entry.heldOut));
    }
    std::printf("%s: %zu scans\n", rawlog.c_str(), scans.size());
    printDistances("map thickness", entries, thickness);
    printDistances("held-out residual", entries, residuals);
    std::printf("there and back: median / worst disagreement (number of the worst step)\n");
    for (const auto& entry : entries) {
        printAgreement(entry.name, "every scan: backwards", entry.all, entry.back);
        printAgreement(entry.name, "every second: backwards", entry.second, entry.secondBack);
        printAgreement(entry.name, "every second against every scan", everySecond(entry.all),
                       entry.second);
    }
    std::printf("against %s's\n", entries[0].name.c_str());
    for (std::size_t e = 1; e < entries.size(); ++e)
        printAgreement(entries[e].name, "", entries[0].all, entries[e].all);
}
}  // namespace

int main(int argc, char** argv) try {
    std::string profile = "accurate", rawlog;
    std::vector<std::string> poses, settings;
    double spacing = 0.15;
    bool withReference = false;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--profile" && i + 1 < argc)
            profile = argv[++i];
        else if (word == "--set" && i + 1 < argc)
            settings.emplace_back(argv[++i]);
        else if (word == "--spacing" && i + 1 < argc)
            spacing = std::stod(argv[++i]);
        else if (word == "--reference")
            withReference = true;
        else if (rawlog.empty())
            rawlog = word;
        else
            poses.push_back(word);
    }
    Options options = Options::ofProfile(profile);
    for (const auto& setting : settings) options.set(setting);
    options.check();
    measure(rawlog, options, poses, spacing, withReference);
} catch (const std::exception& e) {
    std::fprintf(stderr, "benchmark_self_consistency: %s\n", delio::plainMessage(e).c_str());
    return 1;
}
