// Builds a map as point cloud, scene for SceneViewer3D and pictures, without a display. Connects
// odometry, pose graph and map by hand: delio::Slam calls each listener with every step.
//   04_map_and_pictures DRIVE OUTDIR
#include <delio/map/cloud_files.h>
#include <delio/picture/render.h>
#include <delio/picture/scene.h>
#include <delio/recordings/scan_reader.h>
#include <delio/slam/listeners.h>
#include <delio/slam/options.h>
#include <delio/slam/slam.h>

#include <cstdio>
#include <exception>
#include <filesystem>

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "usage: 04_map_and_pictures DRIVE OUTDIR\n");
        return 2;
    }
    const std::filesystem::path folder = argv[2];
    std::filesystem::create_directories(folder);

    const auto reader = delio::io::openScans(argv[1]);
    const auto options = delio::Options::forDrive("accurate", reader->meta());
    delio::Slam slam(delio::makeOdometry(options));
    const auto graph = std::make_shared<delio::GraphBuilder>(options.graph);
    const auto map = std::make_shared<delio::MapListener>(delio::map::MapBuilder(options.map));
    slam.attach(graph);
    slam.attach(map);
    while (const auto scan = reader->next()) slam.process(*scan);
    graph->optimise();
    const auto& poses = graph->graph().poses();

    // What moved is taken out of the map now that all that was seen is known.
    const delio::map::BuiltMap built = map->builder().build(poses);
    delio::map::savePly(built.points, folder / "map.ply");

    namespace picture = delio::picture;
    const picture::MapWays ways{poses, {}, built.keyPoses, {}};
    const auto byHeight = picture::mapScene(built.points, ways);
    picture::saveScene(*byHeight, folder / "map.3Dscene");
    picture::savePicture(*byHeight, {}, folder / "height.png");

    picture::SceneOptions coloured;
    coloured.colourBy = delio::map::ColourBy::Time;
    const auto byTime = picture::mapScene(built.points, ways, coloured);
    picture::savePicture(*byTime, picture::topView(), folder / "time_from_above.png");
    std::printf("%zu points, %zu of what moved, %zu keyframes\n", built.points.size(),
                built.dynamic.size(), built.keyPoses.size());
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "04_map_and_pictures: %s\n", e.what());
    return 1;
}
