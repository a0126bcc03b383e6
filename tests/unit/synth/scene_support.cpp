#include "scene_support.h"

#include <cmath>

#include "delio/io/trajectory.h"
#include "random.h"
#include "test_data.h"

namespace delio::test {
using mrpt::poses::CPose3D;

CPose3D kittiAxes() {
    mrpt::math::CMatrixDouble33 R;
    R.asEigen() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    CPose3D Tr;
    Tr.setRotationMatrix(R);
    return Tr;
}

std::unique_ptr<synth::Scene> sceneOf(const std::string& name, std::uint64_t seed,
                                      std::size_t scans, const std::string& trajectory) {
    return synth::makeScene({name, seed, scans, trajectory, kittiAxes()});
}

void writeEight(const std::filesystem::path& file, double jitter_m) {
    // Two circles that touch, the left one first; both are driven through their common point in
    // the same direction.
    constexpr double kPi = 3.14159265358979323846, kStep_m = 0.8;
    const double round = 2 * kPi * kEightRadius_m;
    io::Trajectory poses;
    synth::Random random{1, 2};
    int standing = 0;
    for (double s = 0; s < 4 * round;) {
        const double way = std::fmod(s, 2 * round);
        const double side = way < round ? 1 : -1;
        const double angle = std::fmod(way, round) / kEightRadius_m;
        const double x = kEightRadius_m * std::sin(angle) + jitter_m * random.normal();
        const double y = side * kEightRadius_m * (1 - std::cos(angle)) + jitter_m * random.normal();
        poses.poses.push_back(CPose3D(x, y, 0.02 * x, side * angle, 0, 0));
        const bool stop = s > 1.3 * round && standing < 30;
        if (stop)
            ++standing;
        else
            s += kStep_m;
    }
    writeText(file, "");
    io::writeKitti(io::lidarToCam0(poses, kittiAxes()), file.string());
}
}  // namespace delio::test
