#include "interpolator.h"

#include "clock.h"
#include "delio/core/geometry.h"
#include "delio/core/text.h"
#include "delio/files/output.h"

namespace delio::io {
// CPose3DInterpolator::saveToTextFile() writes commas where the locale has them.
void writeInterpolator(const Trajectory& trajectory, double epoch_s, const std::string& path) {
    constexpr int kDecimals = 6;
    replaceTextFile(path, [&](std::ostream& out) {
        for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
            const auto time = timeOf(trajectory.stamps_s[i], epoch_s);
            out << fixed(mrpt::Clock::toDouble(time), kDecimals);
            const mrpt::poses::CPose3D pose = toMrpt(trajectory.poses[i]);
            for (const double number :
                 {pose.x(), pose.y(), pose.z(), pose.yaw(), pose.pitch(), pose.roll()})
                out << ' ' << fixed(number, kDecimals);
            out << '\n';
        }
    });
}
}  // namespace delio::io
