#pragma once
#include "delio/localmap/plane_match.h"

namespace delio::translation {
/** What plane residuals say of the translation, the rotation known. */
struct PlaneTranslation {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();         //!< m, the map's frame
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  //!< 1/m^2, the map's frame: H_tt
    Eigen::Matrix3d mixed = Eigen::Matrix3d::Zero();        //!< H_tr, 1/(m rad): t against w
    double weight = 0;                                      //!< sum of the matches' weights
};

/** The closed form: the least-squares translation of the unrotated scan. Along axes that the
 *  normals see with less than `min_share` of their weight there is no step. */
PlaneTranslation translationFromPlanes(const localmap::PlaneMatches& matches,
                                       const Eigen::Matrix3d& R, const Eigen::Vector3d& t,
                                       double min_share);
}  // namespace delio::translation
