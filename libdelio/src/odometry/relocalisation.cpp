#include "delio/odometry/relocalisation.h"

namespace delio {
planes::PlaneEstimate relocalise(const planes::PlaneMap& map,
                                 const surfaces::SurfaceNormals& reference,
                                 const Eigen::Isometry3d& referencePose,
                                 const Eigen::Matrix3Xd& points,
                                 const surfaces::SurfaceNormals& surfaces,
                                 const Eigen::Isometry3d& guess, double radius,
                                 const planes::PlaneRegistrationOptions& options,
                                 const paper::PatternRegistrationOptions& pattern) {
    const Eigen::Matrix3d R = referencePose.linear();
    const auto turned =
        paper::registerPatterns(paper::patternOf(reference), paper::patternOf(surfaces),
                                R.transpose() * guess.linear(), pattern);
    return planes::searchInPlanes(
        map, points, surfaces, isometry(R * turned.rotation, guess.translation()), radius, options);
}
}  // namespace delio
