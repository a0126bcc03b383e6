// Accuracy and time of each stage on drives with known poses: DRIVE.rawlog with DRIVE.poses.txt
// and DRIVE.calib.txt beside it.
//   benchmark_stages [--profile NAME] [--set section.key=value]... DRIVE.rawlog...
#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "coupled_registration.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/evaluation/metrics.h"
#include "delio/formats/drive_meta.h"
#include "delio/formats/trajectory.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/options.h"
#include "odometry/paper_odometry.h"
#include "paper/pattern_registration.h"

namespace {
using namespace delio;
using Eigen::Isometry3d;

/** True motions of the LiDAR from scan to scan. */
std::vector<Isometry3d> trueMotions(const std::string& rawlog) {
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    const auto cam0 = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    std::vector<Isometry3d> motions;
    for (std::size_t i = 1; i < cam0.size(); ++i)
        motions.push_back(Tr.inverse() * cam0[i - 1].inverse() * cam0[i] * Tr);
    return motions;
}

double degreesBetween(const Isometry3d& a, const Isometry3d& b) {
    return angleOf(a.linear().transpose() * b.linear()) * 180 / M_PI;
}

void print(const char* what, std::vector<double> errors, const char* unit) {
    double sum = 0;
    for (const double error : errors) sum += error;
    const double mean = sum / static_cast<double>(errors.size());
    const auto spread = evaluation::spreadOf(std::move(errors));
    std::printf("  %-34s median %8.4f   95 %% %8.4f   max %8.4f   mean %8.4f %s\n", what,
                spread.median, spread.p95, spread.max, mean, unit);
}

/** Errors of one drive, one entry a registered scan. */
struct Errors {
    std::vector<double> rotation, predictedRotation, translation, givenRotation;
    std::vector<double> coupledRotation, coupledTranslation;
    std::vector<double> rotationNes, translationNes;         //!< normalised squared errors, 3 each
    Eigen::Vector3d meanRotation = Eigen::Vector3d::Zero();  //!< deg, signed, sensor's axes
    double iterations = 0;                                   //!< of the pattern's registration
    double along = 0, givenAlong = 0, path = 0;              //!< signed, along the true motion
};

/** What a drive came to. */
struct Run {
    Errors errors;
    std::vector<Named> times_ms;  //!< sums
    std::size_t scans = 0, predicted = 0;
    Isometry3d driven = Isometry3d::Identity(), drivenTruly = Isometry3d::Identity();
};

/** Squared error in units of its covariance. */
double normalised(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
    return error.dot(covariance.ldlt().solve(error));
}

/** The line stage alone with the true rotation given, and the coupled way from the same lines. */
void compareLines(const Isometry3d& truth, const Isometry3d& predicted,
                  const odometry::PaperFeatures& before, const odometry::PaperFeatures& now,
                  const PaperOdometryOptions& options, Errors& errors) {
    const Eigen::Vector3d t = truth.translation();
    errors.iterations +=
        paper::registerPatterns(before.pattern, now.pattern, predicted.linear(), options.pattern)
            .iterations;
    const auto lines = paper::registerLines(before.lines, paper::rotated(now.lines, truth.linear()),
                                            predicted.translation(), options.lineRegistration);
    const Eigen::Vector3d given = lines.translation - t;
    errors.givenRotation.push_back(given.norm());
    if (t.norm() > 0.05) errors.givenAlong += given.dot(t.normalized());
    const auto coupled =
        paper::registerCoupled(before.lines, now.lines, predicted, options.lineRegistration).pose;
    errors.coupledTranslation.push_back((coupled.translation() - t).norm());
    errors.coupledRotation.push_back(degreesBetween(truth, coupled));
}

void compare(const Isometry3d& truth, const Isometry3d& predicted, const Step& step,
             Errors& errors) {
    const Isometry3d& found = step.increment.pose;
    errors.rotation.push_back(degreesBetween(truth, found));
    errors.predictedRotation.push_back(degreesBetween(truth, predicted));
    const Eigen::Vector3d t = truth.translation(), e = found.translation() - t;
    errors.translation.push_back(e.norm());
    if (t.norm() > 0.05) {
        errors.along += e.dot(t.normalized());
        errors.path += t.norm();
    }
    const Matrix6& covariance = step.increment.covariance;
    const Eigen::Matrix3d F = found.linear();
    const Eigen::Vector3d off = rotationLog(F.transpose() * truth.linear());
    errors.meanRotation += off * 180 / M_PI;
    errors.rotationNes.push_back(normalised(off, covariance.bottomRightCorner<3, 3>()));
    errors.translationNes.push_back(
        normalised(F.transpose() * -e, covariance.topLeftCorner<3, 3>()));
}

void add(const std::vector<Named>& times_ms, std::vector<Named>& sums) {
    if (sums.empty())
        sums = times_ms;
    else
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i].second += times_ms[i].second;
}

Run run(const std::string& rawlog, Options options) {
    const auto reader = io::openScans(rawlog);
    if (reader->meta()) options.adaptTo(*reader->meta());
    const auto truth = trueMotions(rawlog);
    const auto odometry = makeOdometry(options);
    odometry::LinearPrediction prediction(options.isPaper() ? options.paper.prediction
                                                            : options.planes.prediction);
    Run run;
    std::shared_ptr<const odometry::PaperFeatures> before;  // the method of planes has none
    while (const auto scan = reader->next()) {
        const auto step = odometry->process(*scan);
        const auto now = std::dynamic_pointer_cast<const odometry::PaperFeatures>(step.features);
        add(step.times_ms, run.times_ms);
        if (run.scans > 0 && run.scans - 1 < truth.size()) {
            const auto& motion = truth[run.scans - 1];
            const auto predicted = prediction.predict();
            compare(motion, predicted, step, run.errors);
            if (now && before)
                compareLines(motion, predicted, *before, *now, options.paper, run.errors);
            prediction.observe(step.increment.pose);
            run.driven = run.driven * step.increment.pose;
            run.drivenTruly = run.drivenTruly * motion;
        }
        run.predicted += step.predicted;
        before = now;
        ++run.scans;
    }
    return run;
}

void print(const std::string& rawlog, const Run& run) {
    const Errors& errors = run.errors;
    const auto scans = static_cast<double>(run.scans);
    std::printf("%s: %zu scans, %.0f m, %zu predicted, end error %.2f %%\n", rawlog.c_str(),
                run.scans, errors.path, run.predicted,
                100 * (run.drivenTruly.inverse() * run.driven).translation().norm() / errors.path);
    print("rotation", errors.rotation, "deg");
    print("rotation, of the prediction", errors.predictedRotation, "deg");
    const Eigen::Vector3d bias = errors.meanRotation / (scans - 1);
    std::printf("  mean rotation error about x, y, z %+.4f %+.4f %+.4f deg\n", bias.x(), bias.y(),
                bias.z());
    print("translation", errors.translation, "m");
    std::printf("  translation along the motion %+.3f %% of the path\n",
                100 * errors.along / errors.path);
    if (!errors.givenRotation.empty()) {
        print("translation, true rotation given", errors.givenRotation, "m");
        std::printf("  along the motion, true rotation given %+.3f %% of the path\n",
                    100 * errors.givenAlong / errors.path);
        print("coupled: rotation", errors.coupledRotation, "deg");
        print("         translation", errors.coupledTranslation, "m");
        std::printf("  pairings of patterns, from the prediction %.1f\n",
                    errors.iterations / (scans - 1));
    }
    print("normalised squared error, rotation", errors.rotationNes, "(3 expected)");
    print("                       translation", errors.translationNes, "(3 expected)");
    std::printf("  ms a scan:");
    for (const auto& [stage, ms] : run.times_ms) std::printf(" %s %.1f", stage.c_str(), ms / scans);
    std::printf("\n");
}
}  // namespace

int main(int argc, char** argv) try {
    std::string profile = "paper";
    std::vector<std::string> drives, settings;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--profile" && i + 1 < argc)
            profile = argv[++i];
        else if (word == "--set" && i + 1 < argc)
            settings.emplace_back(argv[++i]);
        else
            drives.push_back(word);
    }
    Options options = Options::ofProfile(profile);
    for (const auto& setting : settings) options.set(setting);
    options.check();
    for (const auto& drive : drives) print(drive, run(drive, options));
} catch (const std::exception& e) {
    std::fprintf(stderr, "benchmark_stages: %s\n", e.what());
    return 1;
}
