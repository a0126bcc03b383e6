#include "delio/io/recording.h"

#include "delio/core/numbers.h"

namespace delio::io {
std::string describe(const Recording& recording) {
    std::string text = recording.sensor.empty() ? "a LiDAR of unknown model" : recording.sensor;
    if (recording.rate_hz) text += ", " + rounded(*recording.rate_hz, 3) + " Hz";
    if (recording.startsEmpty)
        text += ", no points in its first scans";
    else
        text += recording.pointTimes ? ", points with times" : ", points without times";
    const std::string how = recording.compensationMeasured  ? " (measured)"
                            : recording.compensationAssumed ? " (assumed)"
                                                            : "";
    if (recording.motionCompensated)
        text += (*recording.motionCompensated ? ", de-skewed by the recorder"
                                              : ", not de-skewed by the recorder") +
                how;
    if (recording.scans) text += ", " + std::to_string(*recording.scans) + " scans";
    return text + " (" + recording.kind + ")";
}
}  // namespace delio::io
