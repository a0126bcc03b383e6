#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <zlib.h>

#include "delio/map/cloud_files.h"
#include "delio/map/simplemap.h"
#include "delio/picture/scene.h"
#include "delio/places/stored_map.h"
#include "places/descriptor.h"
#include "seeds.h"

namespace delio::fuzz {
namespace {
map::MapPoints mapPoints() {
    map::MapPoints points(3);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i].position = Eigen::Vector3f(static_cast<float>(i), 2, 3);
    return points;
}

void maps() {
    behind("0", seed("points", "map.ply"),
           [](const fs::path& file) { map::savePly(mapPoints(), file.string()); });
    behind("1", seed("points", "map.pcd"),
           [](const fs::path& file) { map::savePcd(mapPoints(), file.string()); });
    behind("2", seed("points", "map.las"),
           [](const fs::path& file) { map::saveLas(mapPoints(), file.string()); });
    behind("6", seed("clouds", "map.las"),
           [](const fs::path& file) { map::saveLas(mapPoints(), file.string()); });
    behind("0", seed("clouds", "map.pcd"),
           [](const fs::path& file) { map::savePcd(mapPoints(), file.string()); });
    behind("1", seed("clouds", "map.ply"),
           [](const fs::path& file) { map::savePly(mapPoints(), file.string()); });
    const std::string pcd =
        "VERSION 0.7\nFIELDS x y z ring time\nSIZE 4 4 4 2 8\nTYPE F F F U F\nCOUNT 1 1 1 1 1\n"
        "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
    writeText(seed("clouds", "ascii.pcd"), "0" + pcd + "ascii\n1 2 3 4 0.5\n5 6 7 8 0.6\n");
    writeText(seed("clouds", "packed.pcd"),
              "0" + pcd + "binary_compressed\n" + std::string("\x02\0\0\0\x2C\0\0\0\0A", 10));
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty "
        "double z\nproperty uchar intensity\nend_header\n1 2 3 4\n5 6 7 8\n";
    writeText(seed("clouds", "ascii.ply"), "1" + ply);
    writeText(seed("points", "ascii.ply"), "0" + ply);
    writeText(seed("points", "ascii.pcd"), "1" + pcd + "ascii\n1 2 3 4 0.5\n5 6 7 8 0.6\n");
    writeText(seed("clouds", "kitti"), "2" + std::string(32, 'A'));
    writeText(seed("clouds", "text"), "3# points\n1 2 3 0.5\n4 5 6 0.7\n");
    writeText(seed("clouds", "csv"), "4x,y,z,time,ring\n1,2,3,0.1,1\n4,5,6,0.2,2\n");
    writeText(seed("clouds", "times"), "51616513421.123456\n");
    writeText(seed("clouds", "dates"), "52011-09-26 13:02:25.951199337\n");

    mrpt::maps::CSimpleMap keyframes;
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(cloudObservation());
    keyframes.insert(mrpt::poses::CPose3DPDFGaussian::Create(), frame);
    archive(seed("simplemap", "plain"), keyframes);
    map::saveSimplemap(keyframes, seed("simplemap", "gzip").string());
    mrpt::opengl::COpenGLScene::Ptr scene = picture::mapScene(mapPoints(), {});
    archive(seed("scene", "plain"), *scene);
    picture::saveScene(*scene, seed("scene", "gzip").string());
}

/** What `offset`, `bytes` and `unpacked` say at `at` in a stored map. */
std::string unpackedPart(const std::string& file, const std::string& place, std::size_t at) {
    std::uint64_t part[3];
    std::memcpy(part, place.data() + at, sizeof(part));
    std::string plain(part[2], '\0');
    uLongf size = plain.size();
    uncompress(reinterpret_cast<Bytef*>(plain.data()), &size,
               reinterpret_cast<const Bytef*>(file.data() + part[0]), part[1]);
    return plain;
}

void storedMap() {
    MapContent content;
    content.graph = smallGraph();
    content.drives.push_back({"drive", 0, {0, 0.1, 0.2}});
    places::Submap submap;
    submap.last = 2;
    submap.points.resize(3, 0);
    content.submaps.push_back(submap);
    Eigen::Matrix3Xf points = Eigen::Matrix3Xf::Zero(3, 60);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points.col(i) << static_cast<float>(i % 10), static_cast<float>(i / 10),
            0.1F * static_cast<float>(i % 7);
    content.descriptor = [&](std::size_t) { return places::Descriptor(points); };
    content.points = [&](std::size_t) { return points; };
    std::string file;
    const auto save = [&](const std::string& name) {
        behind("0", seed("stored_map", name), [&](const fs::path& path) {
            StoredMap::save(content, path.string());
            file = readText(path);
        });
    };
    save("file");
    const std::size_t end = unpackedPart(file, file, 12).size();  // of the places of the parts
    const auto savePlain = [&](const std::string& name, char version) {
        const std::string index = unpackedPart(file, file, 12);
        const std::string places = index.substr(end - 56);
        std::string plain = "1";
        plain += version;
        for (const std::string& part : {index.substr(0, end - 56), unpackedPart(file, places, 0),
                                        unpackedPart(file, places, 28), index.substr(end)}) {
            plain += static_cast<char>(part.size() % 256);
            plain += static_cast<char>(part.size() / 256);
            plain += part;
        }
        writeText(seed("stored_map", name), plain);
    };
    savePlain("plain", 0);
    content.visits = {{"drive", 1.7e9, 1.7e9}, {"again", 1.8e9, 1.8e9}};
    content.layers = [&](std::size_t) {
        PointLayer gone, fresh;
        gone.against = 2;
        gone.doubted = fresh.first = fresh.last = 1;
        fresh.confirmed = false;
        gone.points = fresh.points = points;
        return std::vector<PointLayer>{gone, fresh};
    };
    save("updated");
    savePlain("visits", 2);
}

}  // namespace

void seedMaps() {
    maps();
    storedMap();
}
}  // namespace delio::fuzz
