#include "map_outputs.h"

#include <filesystem>

#include "delio/core/error.h"
#include "delio/map/cloud_files.h"
#include "delio/map/page.h"
#include "delio/picture/scene.h"

namespace delio {
namespace {
using Options = MapOutputOptions;

void writePly(const MapInput& input, const std::string& path, const Options& options) {
    map::savePly(input.points, path, options.colouring);
}

void writePcd(const MapInput& input, const std::string& path, const Options& options) {
    map::savePcd(input.points, path, options.colouring);
}

void writeLas(const MapInput& input, const std::string& path, const Options&) {
    map::LasPlace place;
    place.coordinatesOf = [&](const Eigen::Vector3d& p) { return p + input.offset; };
    place.wkt = input.wkt;
    place.firstScan_unix_s = input.firstScan_unix_s;
    map::saveLas(input.points, path, place);
}

void writeScene(const MapInput& input, const std::string& path, const Options& options) {
    picture::SceneOptions look;
    look.colourBy = options.colouring.by;
    look.colormap = options.colouring.colormap;
    picture::saveScene(*picture::mapScene(input.points, input.drawnWays(), look), path);
}

void writePage(const MapInput& input, const std::string& path, const Options&) {
    map::PageContent page;
    page.title = input.name;
    page.points = input.points;
    page.dynamic = input.dynamic;
    if (!input.ways.empty()) page.trajectory = input.ways.front();
    page.loops = input.loops;
    page.north = input.north();
    map::savePage(page, path);
}

void writeGridmap(const MapInput& input, const std::string& path, const Options& options) {
    map::saveGridmap(map::occupancyGrid(input.points, input.ways, options.grid, input.sensor),
                     path);
}

void writeMapServer(const MapInput& input, const std::string& path, const Options& options) {
    map::saveMapServer(map::occupancyGrid(input.points, input.ways, options.grid, input.sensor),
                       path);
}
}  // namespace

const std::vector<MapOutput>& mapOutputs() {
    static const std::vector<MapOutput> outputs = {
        {".ply", false, writePly},       {".pcd", false, writePcd},
        {".las", false, writeLas},       {".3Dscene", false, writeScene},
        {".html", false, writePage},     {".gridmap", true, writeGridmap},
        {".yaml", true, writeMapServer},
    };
    return outputs;
}

const MapOutput& mapOutputFor(const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    std::string known;
    for (const auto& output : mapOutputs()) {
        if (extension == output.extension) return output;
        known += (known.empty() ? "" : ", ") + std::string(output.extension);
    }
    throw Error("cannot write '" + path + "': the name must end in one of " + known);
}

std::vector<std::string> filesOf(const std::string& path) {
    if (std::filesystem::path(path).extension() != ".yaml") return {path};
    return {path, map::imageBeside(path)};
}
}  // namespace delio
