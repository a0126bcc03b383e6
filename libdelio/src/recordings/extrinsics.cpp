#include "extrinsics.h"

#include <mrpt/core/format.h>

#include <cmath>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/formats/drive_meta.h"
#include "formats/number_line.h"

namespace delio::io {
namespace {
constexpr double kDegree = M_PI / 180;

Eigen::Isometry3d poseIn(const std::vector<std::string_view>& words) {
    constexpr std::size_t kWords = 7;
    constexpr double kFarthest_m = 1000, kFullTurn_deg = 360;
    if (words.size() != kWords) throw Error("");
    double values[kWords - 1];
    for (std::size_t i = 0; i + 1 < kWords; ++i) {
        const auto number = numberIn<double>(words[i + 1]);
        if (!number || !(std::abs(*number) <= (i < 3 ? kFarthest_m : kFullTurn_deg)))
            throw Error("");
        values[i] = *number;
    }
    return fromMrpt(mrpt::poses::CPose3D(values[0], values[1], values[2], values[3] * kDegree,
                                         values[4] * kDegree, values[5] * kDegree));
}
}  // namespace

Extrinsics readExtrinsics(const std::string& path) {
    const SideFile file = sideFile(path);
    if (file.text.empty()) throw Error("cannot read '" + path + "': it is missing or empty");
    Extrinsics poses;
    std::string_view rest = file.text;
    std::size_t number = 0;
    while (const auto line = nextLine(rest, &number)) {
        const auto words = wordsIn(line->substr(0, line->find('#')));
        if (words.empty()) continue;
        const auto where = "'" + path + "', line " + std::to_string(number) + ": ";
        try {
            if (!poses.emplace(words.front(), poseIn(words)).second)
                throw Error("the sensor '" + std::string(words.front()) + "' is there twice");
        } catch (const Error& e) {
            const std::string why = e.what();
            throw Error(where + (why.empty() ? "expected LABEL x y z yaw pitch roll (metres, "
                                               "degrees)"
                                             : why));
        }
    }
    return poses;
}

std::string extrinsicsLine(const std::string& label, const Eigen::Isometry3d& pose) {
    const auto p = toMrpt(pose);
    return mrpt::format("%s %.5f %.5f %.5f %.4f %.4f %.4f", label.c_str(), p.x(), p.y(), p.z(),
                        p.yaw() / kDegree, p.pitch() / kDegree, p.roll() / kDegree);
}
}  // namespace delio::io
