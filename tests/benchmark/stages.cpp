// Accuracy and time of each stage on drives with known poses: DRIVE.rawlog with DRIVE.poses.txt
// and DRIVE.calib.txt beside it.
//   benchmark_stages [--profile NAME] [--set section.key=value]... DRIVE.rawlog...
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "delio/core/error.h"
#include "delio/evaluation/relative_error.h"
#include "delio/io/drive_meta.h"
#include "delio/io/scan_source.h"
#include "delio/io/trajectory.h"
#include "delio/odometry/odometry.h"
#include "delio/slam/options.h"
#include "delio/paper/coupled_registration.h"

namespace {
using namespace delio;
using mrpt::poses::CPose3D;

/** True motions of the LiDAR from scan to scan. */
std::vector<CPose3D> trueMotions(const std::string& rawlog) {
    const auto Tr = io::readCalibration(io::sidecarPath(rawlog, ".calib.txt")).Tr;
    const auto cam0 = io::readTrajectory(io::sidecarPath(rawlog, ".poses.txt")).poses;
    std::vector<CPose3D> motions;
    for (std::size_t i = 1; i < cam0.size(); ++i)
        motions.push_back((-Tr) + (-cam0[i - 1]) + cam0[i] + Tr);
    return motions;
}

double degreesBetween(const CPose3D& a, const CPose3D& b) {
    const Eigen::Matrix3d A = a.getRotationMatrix().asEigen(), B = b.getRotationMatrix().asEigen();
    const Eigen::Matrix3d D = A.transpose() * B;
    const Eigen::Vector3d skew(D(2, 1) - D(1, 2), D(0, 2) - D(2, 0), D(1, 0) - D(0, 1));
    return std::atan2(skew.norm(), D.trace() - 1) * 180 / M_PI;
}

Eigen::Vector3d translationOf(const CPose3D& pose) { return {pose.x(), pose.y(), pose.z()}; }

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

/** Squared error in units of its covariance. */
double normalised(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
    return error.dot(covariance.ldlt().solve(error));
}

/** The line stage alone with the true rotation given, and the coupled way from the same lines. */
void compareLines(const Eigen::Matrix3d& R, const Eigen::Vector3d& t, const CPose3D& predicted,
                  const Features& before, const Features& now, const OdometryOptions& options,
                  Errors& errors) {
    const Eigen::Vector3d start = translationOf(predicted);
    const auto lines = paper::registerLines(before.lines, paper::rotated(now.lines, R),
                                                  start, options.lineRegistration);
    const Eigen::Vector3d given = lines.translation - t;
    errors.givenRotation.push_back(given.norm());
    if (t.norm() > 0.05) errors.givenAlong += given.dot(t.normalized());
    Eigen::Isometry3d guess = Eigen::Isometry3d::Identity();
    guess.linear() = predicted.getRotationMatrix().asEigen();
    guess.translation() = start;
    const auto coupled =
        paper::registerCoupled(before.lines, now.lines, guess, options.lineRegistration).pose;
    errors.coupledTranslation.push_back((coupled.translation() - t).norm());
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(R.transpose() * coupled.linear()));
    errors.coupledRotation.push_back(turn.angle() * 180 / M_PI);
}

void compare(const CPose3D& truth, const CPose3D& predicted, const OdometryResult& result,
             const Features* before, const OdometryOptions& options, Errors& errors) {
    const CPose3D& found = result.increment.pose;
    errors.iterations += result.registration.rotation.iterations;
    errors.rotation.push_back(degreesBetween(truth, found));
    errors.predictedRotation.push_back(degreesBetween(truth, predicted));
    const Eigen::Vector3d t = translationOf(truth), e = translationOf(found) - t;
    errors.translation.push_back(e.norm());

    const Eigen::Matrix3d R = truth.getRotationMatrix().asEigen();
    if (t.norm() > 0.05) {
        errors.along += e.dot(t.normalized());
        errors.path += t.norm();
    }
    if (result.features && before)
        compareLines(R, t, predicted, *before, *result.features, options, errors);
    const Eigen::Matrix<double, 6, 6> covariance = result.increment.covariance.asEigen();
    const Eigen::Matrix3d F = found.getRotationMatrix().asEigen();
    const Eigen::AngleAxisd off(F.transpose() * R);
    errors.meanRotation += off.angle() * off.axis() * 180 / M_PI;
    errors.rotationNes.push_back(
        normalised(off.angle() * off.axis(), covariance.bottomRightCorner<3, 3>()));
    errors.translationNes.push_back(
        normalised(F.transpose() * -e, covariance.topLeftCorner<3, 3>()));
}

void run(const std::string& rawlog, Options options) {
    const auto meta = io::readDriveMeta(rawlog);
    if (meta) options.adaptTo(*meta);
    const auto truth = trueMotions(rawlog);
    io::ScanSource source(rawlog);
    Odometry odometry(options.odometry);
    LinearPrediction prediction(options.odometry.prediction);
    Errors errors;
    StageTimes times{};
    std::shared_ptr<const Features> before;
    std::size_t scans = 0, predictedScans = 0;
    CPose3D driven, drivenTruly;
    while (const auto scan = source.next()) {
        const auto result = odometry.process(*scan);
        for (std::size_t s = 0; s < kStages; ++s) times[s] += result.times_ms[s];
        if (scans > 0 && scans - 1 < truth.size()) {
            compare(truth[scans - 1], prediction.predict(), result, before.get(), options.odometry,
                    errors);
            prediction.observe(result.increment.pose);
            driven = driven + result.increment.pose;
            drivenTruly = drivenTruly + truth[scans - 1];
        }
        predictedScans += result.predicted;
        before = result.features;
        ++scans;
    }
    std::printf("%s: %zu scans, %.0f m, %zu predicted, end error %.2f %%\n", rawlog.c_str(), scans,
                errors.path, predictedScans,
                100 * translationOf((-drivenTruly) + driven).norm() / errors.path);
    print("rotation", errors.rotation, "deg");
    print("rotation, of the prediction", errors.predictedRotation, "deg");
    const Eigen::Vector3d bias = errors.meanRotation / static_cast<double>(scans - 1);
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
    }
    print("normalised squared error, rotation", errors.rotationNes, "(3 expected)");
    print("                       translation", errors.translationNes, "(3 expected)");
    std::printf("  ms a scan:");
    for (std::size_t s = 0; s < kStages; ++s)
        std::printf(" %s %.1f", kStageNames[s], times[s] / static_cast<double>(scans));
    std::printf("; pairings of patterns %.1f\n",
                errors.iterations / static_cast<double>(scans - 1));
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
    for (const auto& drive : drives) run(drive, options);
} catch (const std::exception& e) {
    std::fprintf(stderr, "benchmark_stages: %s\n", e.what());
    return 1;
}
