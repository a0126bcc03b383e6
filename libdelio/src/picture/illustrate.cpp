#include "delio/picture/illustrate.h"

#include "delio/picture/png.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"

namespace delio::picture {
namespace {
void drawTrajectory(const run::RunRecord& record, const std::string& path) {
    const auto view = topView();
    const auto loops = record.closedLoops();
    const auto pictureOf = [&](const io::Trajectory& trajectory, const char* name) {
        return picture(*trajectoryScene({trajectory.poses, record.truth, {}, loops}, name), view);
    };
    mrpt::img::CImage sheet;
    if (record.optimised()) {
        const auto width = static_cast<int>(view.width_px);
        sheet.resize(std::size_t{2} * view.width_px, view.height_px, mrpt::img::CH_RGB);
        sheet.drawImage(0, 0, pictureOf(record.odometry, "unoptimised"));
        sheet.drawImage(width, 0, pictureOf(record.final, "optimised"));
    } else
        sheet = pictureOf(record.final, "estimate");
    savePng(sheet, path);
}
}  // namespace

void illustrate(const run::RunRecord& record, const map::BuiltMap& map,
                const run::RunFolder& folder) {
    using run::RunFolder;
    if (!map.points.empty()) {
        const auto scene = mapScene(
            map.points, {record.final.poses, record.truth, map.keyPoses, record.closedLoops()});
        saveScene(*scene, folder.path(RunFolder::kScene));
        savePicture(*scene, SnapshotOptions(), folder.path(RunFolder::kMapPicture));
    }
    drawTrajectory(record, folder.path(RunFolder::kTrajectoryPicture));
}
}  // namespace delio::picture
