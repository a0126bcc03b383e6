#pragma once
#include <string>
#include <vector>

namespace delio::synth {
/** A spinning LiDAR. */
struct SensorModel {
    std::string option;                  //!< as --sensor names it
    std::string name;                    //!< as OUT.meta.yaml names it
    std::vector<double> elevations_rad;  //!< of its lasers, the top one first
    int columns = 0;                     //!< firings per turn
    double minRange_m = 0, maxRange_m = 0;
    double encoderStep_rad = 0;  //!< azimuths are given in such steps; 0: as they are
};

/** All that exist. */
std::vector<SensorModel> sensorModels();
}  // namespace delio::synth
