#include "sensor_model.h"

namespace delio::synth {
namespace {
constexpr double kDegree = 3.14159265358979323846 / 180;

/** Two blocks of 32 lasers: steps of 1/3 deg above, of 1/2 deg below. */
SensorModel hdl64e() {
    SensorModel model{"hdl64e", "HDL-64E", {}, 2083, 0.9, 120};
    for (int i = 0; i < 32; ++i) model.elevations_rad.push_back((2 - i / 3.0) * kDegree);
    for (int i = 0; i < 32; ++i) model.elevations_rad.push_back((-8.83 - i / 2.0) * kDegree);
    return model;
}
}  // namespace

std::vector<SensorModel> sensorModels() { return {hdl64e()}; }
}  // namespace delio::synth
