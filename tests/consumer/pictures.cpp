// A run with its pictures, and a picture of a scene: what the component `picture` of the installed
// library adds.  pictures OUTDIR
#include <cstdio>
#include <exception>
#include <filesystem>

#include "box_scan.h"
#include "delio/picture/illustrate.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "delio/run/run.h"

int main(int argc, char** argv) try {
    if (argc != 2) {
        std::fprintf(stderr, "usage: pictures OUTDIR\n");
        return 2;
    }
    delio::run::Run run(delio::Options(), {});
    for (std::size_t i = 0; i < 3; ++i) run.process(scanAt(0.05 * static_cast<double>(i), i));
    run.finish(true);
    const delio::run::RunFolder folder(argv[1]);
    const auto fault = folder.write(run.record(), run.maps(), delio::picture::illustrate);
    if (!fault.empty()) throw delio::Error(fault);

    const auto scene = delio::picture::mapScene(*scanAt(0).points, {});
    const std::string own = (std::filesystem::path(argv[1]) / "box.png").string();
    delio::picture::savePicture(*scene, delio::picture::topView(), own);
    for (const auto& file : {folder.path(delio::run::RunFolder::kMapPicture),
                             folder.path(delio::run::RunFolder::kTrajectoryPicture), own}) {
        const auto bytes = std::filesystem::file_size(file);  // throws where there is none
        std::printf("%s: %ju bytes\n", file.c_str(), bytes);
        if (bytes < 1000) return 1;
    }
    return 0;
} catch (const std::exception& e) {
    std::fprintf(stderr, "pictures: %s\n", e.what());
    return 1;
}
