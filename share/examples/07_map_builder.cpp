// Uses delio::OdometryMapBuilder in place of mrpt::slam::CMetricMapBuilderICP, as icp-slam does: a
// rawlog of sensory frames or observations in, a .simplemap out. Options come from an .ini file.
//   07_map_builder DRIVE.rawlog OUT.simplemap [OPTIONS.ini]
#include <delio/core/error.h>
#include <delio/slam/odometry_map_builder.h>
#include <mrpt/config/CConfigFile.h>
#include <mrpt/io/lazy_load_path.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
    if (argc != 3 && argc != 4) {
        std::fprintf(stderr, "usage: 07_map_builder DRIVE.rawlog OUT.simplemap [OPTIONS.ini]\n");
        return 2;
    }
    delio::OdometryMapBuilderOptions options;
    if (argc == 4) options.loadFromConfigFile(mrpt::config::CConfigFile(argv[3]), "map_builder");
    delio::OdometryMapBuilder builder(options);  // was: mrpt::slam::CMetricMapBuilderICP builder;

    mrpt::obs::CRawlog rawlog;
    if (!rawlog.loadFromRawLogFile(argv[1]))
        throw delio::Error(std::string("cannot read '") + argv[1] + "'");
    mrpt::io::setLazyLoadPathBase(mrpt::obs::CRawlog::detectImagesDirectory(argv[1]));
    for (std::size_t i = 0; i < rawlog.size(); ++i) {
        if (rawlog.getType(i) == mrpt::obs::CRawlog::etObservation) {
            builder.processObservation(rawlog.getAsObservation(i));
        } else if (rawlog.getType(i) == mrpt::obs::CRawlog::etSensoryFrame) {
            mrpt::obs::CActionCollection noAction;
            builder.processActionObservation(noAction, *rawlog.getAsObservations(i));
        }
    }

    mrpt::math::CMatrixDouble66 covariance;  // x y z yaw pitch roll, metres and radians
    mrpt::poses::CPose3D pose;
    builder.getCurrentPoseEstimation()->getCovarianceAndMean(covariance, pose);
    builder.saveCurrentMapToFile(argv[2]);
    std::printf("%u keyframes; the vehicle is at %.3f %.3f %.3f m\n",
                builder.getCurrentlyBuiltMapSize(), pose.x(), pose.y(), pose.z());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "07_map_builder: %s\n", e.what());
    return 1;
}
