#include "delio/picture/illustrate.h"

#include "delio/picture/png.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"

namespace delio::picture {
namespace {
using mrpt::img::CImage;

CImage sideBySide(const CImage& left, const CImage& right) {
    CImage sheet;
    sheet.resize(left.getWidth() + right.getWidth(), left.getHeight(), mrpt::img::CH_RGB);
    sheet.drawImage(0, 0, left);
    sheet.drawImage(static_cast<int>(left.getWidth()), 0, right);
    return sheet;
}

void drawMap(const run::RunRecord& record, const map::BuiltMap& map, const run::RunFolder& folder) {
    const auto scene = mapScene(
        map.points, {record.final.poses, record.truth, map.keyPoses, record.closedLoops()});
    saveScene(*scene, folder.path(run::RunFolder::kScene));
    savePicture(*scene, SnapshotOptions(), folder.path(run::RunFolder::kMapPicture));
}

void drawRemoval(const run::RunRecord& record, const map::BuiltMap& map, const std::string& path) {
    const auto pictureOf = [&](const std::string& caption, bool before) {
        SceneOptions options;
        options.colormap = map::Colormap::Gray;  // has no red
        options.caption = caption;
        const auto scene = mapScene(map.points, {record.final.poses, {}, {}, {}}, options);
        if (before) addRemoved(*scene, map.dynamic);
        return picture(*scene, {});
    };
    const std::string removed = std::to_string(map.dynamic.size()) + " points of what moved";
    savePng(sideBySide(pictureOf("before: in red " + removed, true),
                       pictureOf("after: without " + removed, false)),
            path);
}

void drawTrajectory(const run::RunRecord& record, const std::string& path) {
    const auto view = topView();
    const auto loops = record.closedLoops();
    const auto pictureOf = [&](const io::Trajectory& trajectory, const char* name) {
        return picture(*trajectoryScene({trajectory.poses, record.truth, {}, loops}, name), view);
    };
    savePng(record.optimised() ? sideBySide(pictureOf(record.odometry, "unoptimised"),
                                            pictureOf(record.final, "optimised"))
                               : pictureOf(record.final, "estimate"),
            path);
}
}  // namespace

void illustrate(const run::RunRecord& record, const map::BuiltMap& map,
                const run::RunFolder& folder) {
    using run::RunFolder;
    if (!map.points.empty()) {
        drawMap(record, map, folder);
        if (!map.dynamic.empty()) drawRemoval(record, map, folder.path(RunFolder::kRemovalPicture));
    }
    drawTrajectory(record, folder.path(RunFolder::kTrajectoryPicture));
}
}  // namespace delio::picture
