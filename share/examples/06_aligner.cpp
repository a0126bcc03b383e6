// Uses delio::Aligner in place of mrpt::slam::CICP: both are CMetricMapsAlignmentAlgorithms, so
// only the line that creates it changes. Aligns two scans of a drive.
//   06_aligner DRIVE FIRST SECOND
#include <delio/core/error.h>
#include <delio/odometry/aligner.h>
#include <delio/recordings/scan_reader.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

/** Points of the scan with this number, from 0: metres, sensor's frame. */
mrpt::maps::CPointsMap::Ptr pointsOf(const char* drive, int number) {
    const auto reader = delio::io::openScans(drive);
    for (int i = 0; i < number; ++i) reader->skip();
    const auto scan = reader->next();
    if (!scan) throw delio::Error("there is no scan " + std::to_string(number));
    return scan->points;
}

int main(int argc, char** argv) try {
    if (argc != 4) {
        std::fprintf(stderr, "usage: 06_aligner DRIVE FIRST SECOND\n");
        return 2;
    }
    const auto first = pointsOf(argv[1], std::atoi(argv[2]));
    const auto second = pointsOf(argv[1], std::atoi(argv[3]));

    delio::Aligner aligner;  // was: mrpt::slam::CICP icp;
    delio::Aligner::TReturnInfo info;
    const auto found =
        aligner.Align3DPDF(first.get(), second.get(), mrpt::poses::CPose3DPDFGaussian(), info);

    mrpt::math::CMatrixDouble66 covariance;  // x y z yaw pitch roll, metres and radians
    mrpt::poses::CPose3D pose;               // of the second in the first
    found->getCovarianceAndMean(covariance, pose);
    std::printf("%.4f %.4f %.4f m, %.4f %.4f %.4f deg\n", pose.x(), pose.y(), pose.z(),
                pose.yaw() * 180 / M_PI, pose.pitch() * 180 / M_PI, pose.roll() * 180 / M_PI);
    std::printf("goodness %.3f, residual %.3f m, sigma of x %.4f m\n", info.goodness,
                info.residual_m, std::sqrt(covariance(0, 0)));
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "06_aligner: %s\n", e.what());
    return 1;
}
