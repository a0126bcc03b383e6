#pragma once
#include <mrpt/img/TColor.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CRenderizableShaderPoints.h>

#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "framing.h"
#include "legend_layer.h"
#include "scale_bar.h"

namespace delio::picture {
/** What rendering changes in a scene, put back when it is over. Sizes in pixels (points, text) are
 *  multiplied, as the picture is rendered larger than it is wanted. */
class PreparedScene {
 public:
    /** @param enlarged how many times as large as wanted the picture is rendered
     *  @param view decides on the size of points */
    PreparedScene(mrpt::opengl::COpenGLScene& scene, const SnapshotOptions& options, float enlarged,
                  const View& view);
    ~PreparedScene();
    PreparedScene(const PreparedScene&) = delete;
    PreparedScene& operator=(const PreparedScene&) = delete;

    void lookFrom(const View& view);

    /** The scene's own texts and its bar of colours, and the scale bar's text and plate. The
     *  prepared scene has none of them. */
    LegendLayer legend(const std::optional<ScaleBar>& bar) const;

    /** Stands out against the background. */
    mrpt::img::TColor ink() const;

 private:
    struct Size {
        std::shared_ptr<mrpt::opengl::CRenderizableShaderPoints> points;
        float pixels;
        bool variable;
    };
    using Viewport = mrpt::opengl::COpenGLViewport::Ptr;

    void enlargePoints(const View& view);
    /** Of the map's points, as they are rendered: such that surfaces look closed. */
    float mapPointSize(float stored_px, const View& view) const;
    void enlargeOtherViewports();
    void addScaleBar(const ScaleBar& bar, LegendLayer& layer) const;
    /** From 1 on it is pixels, below a share of the picture. */
    double larger(double v) const { return v >= 1 ? v * double{marks_} : v; }

    mrpt::opengl::COpenGLScene& scene_;
    Viewport viewport_;
    const SnapshotOptions& options_;
    float enlarged_, marks_;
    float clipNear_ = 0, clipFar_ = 0;
    mrpt::img::TColorf background_;
    std::vector<Size> sizes_;
    std::vector<std::pair<Viewport, std::unique_ptr<mrpt::io::CMemoryStream>>> others_;
    struct Bar {
        Viewport viewport;
        double x, y, width, height;
    };
    std::vector<Bar> bars_;
    std::map<uint32_t, mrpt::opengl::CTextMessageCapable::DataPerText> texts_;
};
}  // namespace delio::picture
