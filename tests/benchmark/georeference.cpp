// Error of a georeferenced drive (share/doc/method/georeference.md).
//   benchmark_georeference [--seeds N] DRIVE.rawlog RESULTS ...
// DRIVE.rawlog is one of synth2rawlog with --gnss, RESULTS the folder of its run by delio-slam
// with --no-gnss. For each noise of the fixes (one a second), without and with a tenth of them
// wrong by 20 m, N sets of fixes are drawn about the true places of the antenna. A line each: the
// median over the seeds of the errors of the poses on the earth and of the heading, of the fit
// afterwards (rigid) and with the fixes in the graph.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "delio/core/text.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/georeference.h"
#include "delio/formats/trajectory.h"
#include "delio/run/run_folder.h"
#include "slam/georeferencing.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Poses = std::vector<Isometry3d>;

/** A drive with its truth. */
struct Drive {
    graph::PoseGraph graph;
    earth::Track track;
    Poses truth;  //!< east, north, up
    earth::Georeference place;
    earth::Fixes exact;  //!< true places of the antenna
};

earth::Georeference georeferenceIn(const std::string& text) {
    std::istringstream in(text);
    std::string line;
    earth::Georeference place;
    std::getline(in, line);
    auto numbers = numbersIn(line.substr(line.rfind("height") + 6));
    place.origin = {numbers.at(0), numbers.at(1), numbers.at(2)};
    std::getline(in, line);
    numbers = numbersIn(line.substr(line.rfind("map") + 3));
    for (int i = 0; i < 12; ++i)
        place.enuFromMap.matrix()(i / 4, i % 4) = numbers.at(static_cast<std::size_t>(i));
    return place;
}

Drive read(const std::string& rawlog, const std::string& results) {
    Drive drive;
    const run::RunFolder folder(results);
    drive.graph = folder.graph();
    const auto scans = folder.scans();
    drive.track = {drive.graph.poses(), scans.stamps_s, {}};
    for (const bool predicted : scans.predicted) drive.track.usable.push_back(!predicted);
    const auto gnss = io::sidecarPath(rawlog, ".gnss.csv");
    drive.place = georeferenceIn(io::sideFile(gnss).text);
    drive.exact = io::readFixes(gnss);
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    const auto cam0 = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    for (const auto scan : scans.scans)
        drive.truth.push_back(drive.place.enuFromMap * Tr.inverse() * cam0.at(scan) * Tr);
    return drive;
}

earth::Fixes fixesOf(const Drive& drive, double sigma_m, double wrong, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0, 1);
    const earth::EnuFrame enu(drive.place.origin);
    earth::Fixes fixes;
    for (const auto& exact : drive.exact) {
        if (!fixes.empty() && exact.stamp_s < fixes.back().stamp_s + 0.99) continue;
        auto fix = exact;
        Vector3d error(normal(random), normal(random), 2 * normal(random));
        error *= sigma_m;
        const double azimuth = 2 * M_PI * unit(random);
        if (unit(random) < wrong) error += 20 * Vector3d(std::cos(azimuth), std::sin(azimuth), 0);
        fix.place = enu.geodeticOf(enu.enuOf(exact.place) + error);
        fix.covariance = sigma_m * sigma_m * Vector3d(1, 1, 4).asDiagonal().toDenseMatrix();
        fix.antenna = Vector3d(-0.8, 0.3, 0.5);  // synth2rawlog's
        fixes.push_back(fix);
    }
    return fixes;
}

/** Errors in metres and degrees, of the whole trajectory. */
struct Errors {
    double horizontal = 0, up = 0, heading = 0, sigma = 0, ape = 0;
    std::size_t rejected = 0;
};

Errors errorsOf(const Drive& drive, const Georeferenced& found) {
    Errors errors;
    const earth::EnuFrame enu(drive.place.origin);
    Poses poses;
    for (std::size_t i = 0; i < drive.truth.size(); ++i) {
        poses.push_back(found.graph.poses()[i]);
        const Vector3d error = enu.enuOf(found.place.geodeticOf(poses.back().translation())) -
                               drive.truth[i].translation();
        errors.horizontal += error.head<2>().squaredNorm();
        errors.up += error.z() * error.z();
    }
    const auto count = static_cast<double>(poses.size());
    errors.horizontal = std::sqrt(errors.horizontal / count);
    errors.up = std::sqrt(errors.up / count);
    errors.heading = std::abs(std::remainder(
        earth::heading_deg(found.place.enuFromMap) - earth::heading_deg(drive.place.enuFromMap),
        360));
    errors.sigma = found.figures.headingSigma_deg;
    errors.ape = evaluation::absoluteError(drive.truth, poses).rmse_m;
    errors.rejected = found.figures.rejected;
    return errors;
}

double median(const std::vector<Errors>& all, double Errors::*member) {
    std::vector<double> values;
    for (const auto& errors : all) values.push_back(errors.*member);
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

void measure(const Drive& drive, double sigma_m, double wrong, int seeds) {
    for (const bool inGraph : {false, true}) {
        std::vector<Errors> all;
        std::size_t rejected = 0, refused = 0;
        for (int seed = 1; seed <= seeds; ++seed) {
            const graph::PoseGraphOptions options;
            const auto found = georeferenced(
                drive.graph, drive.track,
                fixesOf(drive, sigma_m, wrong, static_cast<std::uint32_t>(1000 * seed)),
                inGraph ? &options : nullptr);
            if (!found.figures.refusal.empty()) {
                std::fprintf(stderr, "%s\n", found.figures.refusal.c_str());
                ++refused;
                continue;
            }
            all.push_back(errorsOf(drive, found));
            rejected += all.back().rejected;
        }
        if (all.empty()) continue;
        std::printf("%6.2f %5.0f%% %-6s %8.3f %8.3f %8.3f %8.3f %8.3f %6.1f %3zu\n", sigma_m,
                    100 * wrong, inGraph ? "graph" : "rigid", median(all, &Errors::horizontal),
                    median(all, &Errors::up), median(all, &Errors::heading),
                    median(all, &Errors::sigma), median(all, &Errors::ape),
                    static_cast<double>(rejected) / static_cast<double>(all.size()), refused);
    }
}
}  // namespace

int main(int argc, char** argv) {
    try {
        int seeds = 5, first = 1;
        if (argc > 2 && std::string(argv[1]) == "--seeds") {
            seeds = numberIn<int>(argv[2]).value_or(seeds);
            first = 3;
        }
        for (int i = first; i + 1 < argc; i += 2) {
            const Drive drive = read(argv[i], argv[i + 1]);
            std::printf("%s: %.0f m, %zu scans, APE of the run %.3f m\n", argv[i],
                        evaluation::pathLength_m(drive.truth), drive.truth.size(),
                        evaluation::absoluteError(drive.truth, drive.graph.poses()).rmse_m);
            std::printf("%6s %6s %-6s %8s %8s %8s %8s %8s %6s %3s\n", "noise", "wrong", "method",
                        "hor_m", "up_m", "head_deg", "sigma", "APE_m", "reject", "ref");
            for (const double sigma_m : {0.02, 2.0})
                for (const double wrong : {0.0, 0.1}) measure(drive, sigma_m, wrong, seeds);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
