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
constexpr std::size_t kWords = 7;  // of a line
constexpr const char* kImu = "imu";

/** Of the six words that follow the first one. */
Eigen::Isometry3d poseIn(const std::vector<std::string_view>& words) {
    constexpr double kFarthest_m = 1000, kFullTurn_deg = 360;
    double values[6];
    for (std::size_t i = 0; i < 6; ++i) {
        const auto number = numberIn<double>(words[i + 1]);
        if (!number || !(std::abs(*number) <= (i < 3 ? kFarthest_m : kFullTurn_deg)))
            throw Error("");
        values[i] = *number;
    }
    return fromMrpt(mrpt::poses::CPose3D(values[0], values[1], values[2], values[3] * kDegree,
                                         values[4] * kDegree, values[5] * kDegree));
}

ImuMount imuIn(const std::vector<std::string_view>& words) {
    constexpr double kMost_s = 0.1;
    ImuMount imu{poseIn(words), {}};
    if (words.size() == kWords) return imu;
    imu.offset_s = numberIn<double>(words[kWords]);
    if (!imu.offset_s || !(std::abs(*imu.offset_s) <= kMost_s))
        throw Error("the offset of an IMU's clock is a number of seconds from -0.1 to 0.1");
    return imu;
}

/** Throws Error, with a reason where another one than that it is no such line. */
void take(const std::vector<std::string_view>& words, ExtrinsicsFile& file) {
    const bool isImu = words.front() == kImu;
    if (words.size() != kWords && !(isImu && words.size() == kWords + 1)) throw Error("");
    const bool isTwice =
        isImu ? file.imu.has_value() : file.lidars.count(std::string(words.front())) > 0;
    if (isTwice) throw Error("the sensor '" + std::string(words.front()) + "' is there twice");
    if (isImu)
        file.imu = imuIn(words);
    else
        file.lidars.emplace(words.front(), poseIn(words));
}
}  // namespace

ExtrinsicsFile readExtrinsics(const std::string& path) {
    const SideFile text = sideFile(path);
    if (text.text.empty()) throw Error("cannot read '" + path + "': it is missing or empty");
    ExtrinsicsFile file;
    std::string_view rest = text.text;
    std::size_t number = 0;
    while (const auto line = nextLine(rest, &number)) {
        const auto words = wordsIn(line->substr(0, line->find('#')));
        if (words.empty()) continue;
        try {
            take(words, file);
        } catch (const Error& e) {
            const std::string why = e.what();
            throw Error(
                "'" + path + "', line " + std::to_string(number) + ": " +
                (why.empty() ? "expected LABEL x y z yaw pitch roll (metres, degrees)" : why));
        }
    }
    if (file.lidars.empty() && !file.imu) throw Error("'" + path + "' has no pose of a sensor");
    return file;
}

std::string extrinsicsLine(const std::string& label, const Eigen::Isometry3d& pose) {
    const auto p = toMrpt(pose);
    return mrpt::format("%s %.5f %.5f %.5f %.4f %.4f %.4f", label.c_str(), p.x(), p.y(), p.z(),
                        p.yaw() / kDegree, p.pitch() / kDegree, p.roll() / kDegree);
}

std::string extrinsicsLine(const ImuMount& imu) {
    return extrinsicsLine(kImu, imu.pose) +
           (imu.offset_s ? mrpt::format(" %.5f", *imu.offset_s) : "");
}
}  // namespace delio::io
