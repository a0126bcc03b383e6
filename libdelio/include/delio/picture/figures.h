#pragma once
#include <mrpt/opengl/COpenGLScene.h>

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "delio/core/odometry_options.h"
#include "delio/odometry/scan.h"
#include "delio/picture/render.h"
#include "delio/run/run_folder.h"

namespace delio::picture {
/** Patterns of normals (unit vectors), each on a unit sphere of its own, side by side from left to
 *  right, coloured by their place on the sphere so that a pattern can be followed from one to the
 *  next; a caption each. In the axes of the sensor: x away from the viewer of sphereView(), for
 * which the far side is paler. */
mrpt::opengl::COpenGLScene::Ptr sphereScene(const std::vector<Eigen::Matrix3Xf>& patterns,
                                            const std::vector<std::string>& captions);

/** The spheres of sphereScene() as a reader of the paper looks at them: from behind and above. */
SnapshotOptions sphereView(std::size_t spheres);

/** What the paper's stages make of scan after scan, as scenes for a live view. */
class PaperStages {
 public:
    /** What there is to see of a scan. */
    struct Scenes {
        /** The pattern of its normals without outliers, as sphereScene() draws it. */
        mrpt::opengl::COpenGLScene::Ptr pattern;
        /** Its lines paired with those of the scan before; null at the first scan. */
        mrpt::opengl::COpenGLScene::Ptr matches;
    };

    /** The stages' options, which are copied. */
    explicit PaperStages(const PaperOdometryOptions& options);
    ~PaperStages();
    PaperStages(const PaperStages&) = delete;
    PaperStages& operator=(const PaperStages&) = delete;

    /** The next scan. `increment`: maps the scan's frame to that of the scan before, metres. */
    Scenes add(const Scan& scan, const Eigen::Isometry3d& increment);

 private:
    struct Lines;
    PaperOdometryOptions options_;
    std::unique_ptr<Lines> before_;  //!< null at the first scan
};

/** The pictures of a run: map.3Dscene and map.png where there are points, map_removal.png
 *  where something dynamic was taken out of them, before (in red what was) beside after in the same
 *  view, and trajectory.png, from above; where the graph had something to optimise, before and
 * after it side by side. To be given to run::RunFolder::write(). Throws Error where one cannot be
 * drawn or written. */
void illustrate(const run::RunRecord& record, const map::BuiltMap& map,
                const run::RunFolder& folder);
}  // namespace delio::picture
