#pragma once

namespace delio::synth {
/** Half the distance between what touches the ground: front and rear, left and right. */
struct Footprint {
    double along_m, across_m;
};

/** Carrier of the sensor. */
struct Carrier {
    Footprint footprint{1.35, 0.75};
    double sensorHeight_m = 1.73;
    /** It tilts with the ground, and its roof hides what is below; a person stays upright. */
    bool isVehicle = true;
    /** A vehicle's own body is filtered out; a hand-held sensor sees nearer points, too. */
    double nearest_m = 1e3;
};

/** A person with the sensor held before the chest. */
inline Carrier onFoot() { return {{0.25, 0.15}, 1.35, false, 0.5}; }
}  // namespace delio::synth
