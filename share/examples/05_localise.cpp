// Localises a vehicle in the map of another drive (result folder of delio-slam or 01_odometry),
// without an initial guess, then tracks it scan by scan.
//   05_localise MAP_FOLDER|MAP.delio DRIVE
#include <delio/recordings/scan_reader.h>
#include <delio/run/run_folder.h>
#include <delio/slam/localiser.h>

#include <cmath>
#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
    if (argc != 3) {
        std::fprintf(stderr, "usage: 05_localise MAP_FOLDER|MAP.delio DRIVE\n");
        return 2;
    }
    const auto map = std::make_shared<const delio::StoredMap>(delio::run::storedMapIn(argv[1]));
    const auto reader = delio::io::openScans(argv[2]);
    delio::Localiser localiser(map, delio::Options::forDrive("accurate", reader->meta()));
    // localiser.expect(pose) where it is known to some metres

    bool found = false;
    while (const auto scan = reader->next()) {
        const delio::MapFix fix = localiser.process(*scan).fix;
        if (fix.where == delio::Whereabouts::kUnknown) {
            std::printf("%zu unknown\n", scan->index);
            continue;
        }
        found = true;
        const auto& place = fix.vehicle.pose.translation();
        const double sigma = std::sqrt(fix.vehicle.covariance.topLeftCorner<3, 3>().trace());
        std::printf("%zu %s %.3f %.3f %.3f +- %.3f m, %s\n", scan->index,
                    fix.where == delio::Whereabouts::kInMap ? "in_map" : "outside", place.x(),
                    place.y(), place.z(), sigma, fix.measured ? "measured" : "by the odometry");
    }
    return found ? 0 : 1;
} catch (const std::exception& e) {
    std::fprintf(stderr, "05_localise: %s\n", e.what());
    return 1;
}
