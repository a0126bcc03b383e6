#pragma once
#include <optional>
#include <vector>

#include "chain.h"
#include "delio/places/submap.h"
#include "poses.h"
#include "ring_scan.h"

/** Drives through a small town for tests of loops. */
namespace delio::places_test {
using Poses = std::vector<Eigen::Isometry3d>;
using test::chainOf;

/** DenseSubmap and houses on both sides of the streets about a block of 60 m by 40 m, none like the
 *  other; `alike`: houses that repeat every 12 m. */
inline test::Scene town(bool alike = false) {
    test::Scene scene{{{-100, -100, -2.8}, {160, 140, -1.8}}};
    test::Noise noise(11);
    for (int i = -4; i < 10; ++i)
        for (const double y : {-12.0, 8.0, 28.0, 48.0}) {
            const double x = 12 * i, r = alike ? 0 : 1;
            scene.push_back({{x + r * noise.uniform(), y + 1.5 * r * noise.uniform(), -2},
                             {x + 7 + 2 * r * noise.uniform(), y + 4 + r * noise.uniform(),
                              5 + 3 * r * noise.uniform()}});
        }
    return scene;
}

/** Once round the block, a scan every 2 m, and on for `more` scans. */
inline Poses roundTheBlock(int more) {
    Poses poses{test::poseAt(0, 0, 0)};
    constexpr int kCorner = 6;
    for (const int straight : {25, 15, 25, 15}) {
        for (int i = 0; i < straight; ++i) poses.push_back(poses.back() * test::poseAt(2, 0, 0));
        for (int i = 0; i < kCorner; ++i)
            poses.push_back(poses.back() * test::poseAtDeg(2, 0, 0, 90.0 / kCorner));
    }
    for (int i = 0; i < more; ++i) poses.push_back(poses.back() * test::poseAt(2, 0, 0));
    return poses;
}

/** The same steps, each turned and stretched a little more than it was. */
inline Poses drifted(const Poses& poses, double turn_deg, double stretch, double climb_deg) {
    Poses result{poses.front()};
    for (std::size_t i = 1; i < poses.size(); ++i) {
        Eigen::Isometry3d step = poses[i - 1].inverse() * poses[i];
        step.translation() *= 1 + stretch;
        result.push_back(result.back() * step * test::poseAtDeg(0, 0, 0, turn_deg, climb_deg, 0));
    }
    return result;
}

/** What was seen from the true poses, where `believed` puts it; `gap`: the increment to the scan
 *  `gapBefore`, if any. */
inline std::vector<places::Submap> submapsOf(const test::Scene& scene, const Poses& truth,
                                             const Poses& believed, std::size_t gapBefore = 0,
                                             const Increment& gap = {}) {
    places::SubmapBuilder builder{{}};
    std::vector<places::Submap> submaps;
    const auto take = [&](std::future<places::Submap> ended) {
        if (ended.valid()) submaps.push_back(ended.get());
    };
    test::Noise noise;
    Increment step{{}, 1e-6 * Matrix6::Identity()};
    for (std::size_t i = 0; i < truth.size(); ++i) {
        step.pose = i > 0 ? believed[i - 1].inverse() * believed[i] : Eigen::Isometry3d::Identity();
        take(builder.add(i, i > 0 && i == gapBefore ? gap : step,
                         test::ringScan(scene, truth[i], {24, 360, -24, 12, 0.01}, noise).points,
                         Eigen::Vector3d::UnitZ()));
    }
    take(builder.finish());
    return submaps;
}
}  // namespace delio::places_test
