#pragma once
#include <memory>

#include "../places/town.h"
#include "delio/places/stored_map.h"
#include "places/descriptor.h"
#include "test_data.h"

/** Maps of the town in town.h. */
namespace delio::localisation_test {
using namespace delio::places_test;

/** Submaps that a drive along these poses makes, as content of a map. */
struct TownDrive {
    explicit TownDrive(const Poses& poses, const test::Scene& scene = town(),
                       const std::string& name = "town")
        : submaps(submapsOf(scene, poses, poses)) {
        content.graph = chainOf(poses);
        content.drives.push_back({name, 0, {}});
        for (std::size_t i = 0; i < poses.size(); ++i)
            content.drives[0].stamps_s.push_back(0.1 * static_cast<double>(i));
        content.submaps = submaps;
        for (auto& submap : content.submaps) submap.points.resize(3, 0);
        content.descriptor = [this](std::size_t i) {
            return places::Descriptor(submaps[i].points);
        };
        content.points = [this](std::size_t i) { return submaps[i].points; };
    }
    TownDrive(const TownDrive&) = delete;
    TownDrive& operator=(const TownDrive&) = delete;

    std::vector<places::Submap> submaps;
    MapContent content;
};

inline std::string fileIn(const test::TemporaryFolder& folder,
                          const std::string& name = "map.delio") {
    return (folder / name).string();
}

/** What a sensor on the vehicle sees there. */
inline Eigen::Matrix3Xf seenFrom(const test::Scene& scene, const Eigen::Isometry3d& pose,
                                 test::Noise& noise) {
    return test::ringScan(scene, pose, {24, 360, -24, 12, 0.01}, noise).points;
}
}  // namespace delio::localisation_test
