#pragma once
#include <mrpt/obs/VelodyneCalibration.h>

#include <cstdint>
#include <string>

#include "../velodyne_packets.h"

namespace delio::io {
/** A Velodyne that a data packet can be of. */
struct VelodyneModel {
    std::string name;  //!< e.g. "VLP-16"
    mrpt::obs::VelodyneCalibration calibration;
    VelodyneLayout layout;
};

/** Of the sensor that sent a data packet (1206 bytes): "HDL-64E" by its blocks of the lower bank
 *  of two, a VLS-128 by those of its third and fourth bank, others by the factory byte. Throws
 * Error for one that is not known, or known but not decoded. */
std::string velodyneModelName(const std::uint8_t* packet);

/** `calibrationFile`: an .xml or .yaml as MRPT reads it; empty: the model's usual one. Throws Error
 *  where that cannot be read, is of another number of lasers, or there is no usual one. */
VelodyneModel velodyneModel(const std::string& name, const std::string& calibrationFile);
}  // namespace delio::io
