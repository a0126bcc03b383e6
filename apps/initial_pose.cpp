#include "initial_pose.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/numbers.h"

namespace delio {
namespace {
/** `count` finite numbers with commas between; else empty. */
std::vector<double> numbersIn(const std::string& text, std::size_t count) {
    std::vector<double> numbers;
    std::istringstream in(text + ",");
    for (std::string word; std::getline(in, word, ',');) {
        const auto number = numberIn<double>(word);
        if (!number || !std::isfinite(*number)) return {};
        numbers.push_back(*number);
    }
    const auto commas = static_cast<std::size_t>(std::count(text.begin(), text.end(), ','));
    if (numbers.size() != count || commas + 1 != count) return {};
    return numbers;
}
}  // namespace

Eigen::Isometry3d initialPoseIn(const std::string& text) {
    const auto numbers = numbersIn(text, 4);
    if (numbers.empty())
        throw Error(
            "--initial-pose needs X,Y,Z,YAW_DEG (metres and degrees in the map's frame), not '" +
            text + "'");
    return isometry(rotationExp({0, 0, numbers[3] * M_PI / 180}),
                    {numbers[0], numbers[1], numbers[2]});
}

Eigen::Vector3d antennaIn(const std::string& text) {
    const auto numbers = numbersIn(text, 3);
    if (numbers.empty() || Eigen::Vector3d(numbers.data()).norm() > 100)
        throw Error("--antenna needs X,Y,Z (metres in the vehicle frame), not '" + text + "'");
    return Eigen::Vector3d(numbers.data());
}

Eigen::AlignedBox3d vehicleBoxIn(const std::string& text) {
    const auto numbers = numbersIn(text, 6);
    Eigen::AlignedBox3d box;
    if (!numbers.empty())
        box = {Eigen::Vector3d(numbers.data()), Eigen::Vector3d(numbers.data() + 3)};
    if (box.isEmpty())
        throw Error(
            "--vehicle-box needs XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX (metres in the vehicle frame), not "
            "'" +
            text + "'");
    return box;
}
}  // namespace delio
