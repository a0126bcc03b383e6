#include "sensor_model.h"

namespace delio::synth {
namespace {
constexpr double kDegree = 3.14159265358979323846 / 180;

/** `count` lasers in even steps from the top one down. */
void addBlock(SensorModel& model, int count, double top_deg, double step_deg) {
    for (int i = 0; i < count; ++i)
        model.elevations_rad.push_back((top_deg - i * step_deg) * kDegree);
}

/** Two blocks of 32 lasers: steps of 1/3 deg above, of 1/2 deg below. */
SensorModel hdl64e() {
    SensorModel model{"hdl64e", "HDL-64E", {}, 2083, 0.9, 120, 0.09 * kDegree};
    addBlock(model, 32, 2, 1 / 3.0);
    addBlock(model, 32, -8.83, 0.5);
    return model;
}

SensorModel hdl32e() {
    SensorModel model{"hdl32e", "HDL-32E", {}, 2170, 0.9, 100, 0.01 * kDegree};
    addBlock(model, 32, 10 + 2 / 3.0, 4 / 3.0);
    return model;
}

SensorModel vlp16() {
    SensorModel model{"vlp16", "VLP-16", {}, 1808, 0.9, 100, 0.01 * kDegree};
    addBlock(model, 16, 15, 2);
    return model;
}

/** The first generation, of 33.2 deg from top to bottom. */
SensorModel os1x64() {
    SensorModel model{"os1-64", "OS1-64", {}, 1024, 0.8, 120, 0};
    addBlock(model, 64, 16.6, 33.2 / 63);
    return model;
}
}  // namespace

std::vector<SensorModel> sensorModels() { return {hdl64e(), hdl32e(), vlp16(), os1x64()}; }
}  // namespace delio::synth
