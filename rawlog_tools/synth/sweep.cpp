#include "sweep.h"

#include "random.h"

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kPhaseKey = 0x9A5E;
}  // namespace

double firingTime(double azimuth_rad) {
    const double left = azimuth_rad > kPi ? azimuth_rad - 2 * kPi : azimuth_rad;
    return -left / (2 * kPi) * kScanPeriod_s;
}

Sweep sweepOf(const Drive& drive, std::size_t scan, const SensorModel& sensor, bool distort,
              std::uint64_t seed, const SecondSensor& mounted) {
    // The head turns freely: no two scans have their columns at the same azimuths.
    const double phase = Random{seed, kPhaseKey, scan}.uniform() * 0.5;
    const auto columns = static_cast<std::size_t>(sensor.columns);
    Sweep sweep;
    sweep.stamp_s = kScanPeriod_s * static_cast<double>(scan) + mounted.later_s;
    for (std::size_t c = 0; c < columns; ++c)
        sweep.azimuth_rad.push_back(2 * kPi * (static_cast<double>(c) + phase) /
                                    static_cast<double>(columns));
    if (!distort) {
        sweep.time_s.assign(columns, 0);
        sweep.lidarToWorld.assign(columns, drive.lidarPoseAt(sweep.stamp_s) * mounted.pose);
        return sweep;
    }
    for (const double azimuth : sweep.azimuth_rad) {
        sweep.time_s.push_back(firingTime(azimuth));
        sweep.lidarToWorld.push_back(drive.lidarPoseAt(sweep.stamp_s + sweep.time_s.back()) *
                                     mounted.pose);
    }
    return sweep;
}
}  // namespace delio::synth
