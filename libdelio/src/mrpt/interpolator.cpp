#include "interpolator.h"

#include <mrpt/poses/CPose3DInterpolator.h>

#include "clock.h"
#include "delio/core/geometry.h"
#include "delio/files/output_file.h"

namespace delio::io {
void writeInterpolator(const Trajectory& trajectory, double epoch_s, const std::string& path) {
    mrpt::poses::CPose3DInterpolator poses;
    for (std::size_t i = 0; i < trajectory.poses.size(); ++i)
        poses.insert(timeOf(trajectory.stamps_s[i], epoch_s), toMrpt(trajectory.poses[i]));
    replaceFile(path, [&](const std::string& file) { return poses.saveToTextFile(file); });
}
}  // namespace delio::io
