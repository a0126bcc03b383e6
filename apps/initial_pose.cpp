#include "initial_pose.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/numbers.h"

namespace delio {
Eigen::Isometry3d initialPoseIn(const std::string& text) {
    std::vector<double> numbers;
    std::istringstream in(text + ",");
    for (std::string word; std::getline(in, word, ',');) {
        const auto number = numberIn<double>(word);
        if (!number || !std::isfinite(*number)) break;
        numbers.push_back(*number);
    }
    if (numbers.size() != 4 || std::count(text.begin(), text.end(), ',') != 3)
        throw Error(
            "--initial-pose needs X,Y,Z,YAW_DEG (metres and degrees in the map's frame), not '" +
            text + "'");
    return isometry(rotationExp({0, 0, numbers[3] * M_PI / 180}),
                    {numbers[0], numbers[1], numbers[2]});
}
}  // namespace delio
