#pragma once

namespace delio::synth {
/** One that vehicles drive on. */
struct Lane {
    double side_m;     //!< its middle, from the road's centre line
    int direction;     //!< +1: with the vehicle, -1: against it
    double speed_m_s;  //!< of traffic that flows freely
};
}  // namespace delio::synth
