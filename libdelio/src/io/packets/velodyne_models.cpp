#include "velodyne_models.h"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>

#include "core/portable_math.h"
#include "delio/core/error.h"

namespace delio::io {
using mrpt::obs::VelodyneCalibration;

namespace {
constexpr std::size_t kLasers32C = 32;
/** Elevation and azimuth offset (clockwise) of each laser of a VLP-32C in degrees, in the order of
 *  a packet: VLP-32C User Manual, tables 9-2 and 9-6. */
constexpr std::array<std::array<double, 2>, kLasers32C> kLasersOf32C{
    {{-25, 1.4},    {-1, -4.2},     {-1.667, 1.4}, {-15.639, -1.4}, {-11.31, 1.4}, {0, -1.4},
     {-0.667, 4.2}, {-8.843, -1.4}, {-7.254, 1.4}, {0.333, -4.2},   {-0.333, 1.4}, {-6.148, -1.4},
     {-5.333, 4.2}, {1.333, -1.4},  {0.667, 4.2},  {-4, -1.4},      {-4.667, 1.4}, {1.667, -4.2},
     {1, 1.4},      {-3.667, -4.2}, {-3.333, 4.2}, {3.333, -1.4},   {2.333, 1.4},  {-2.667, -1.4},
     {-3, 1.4},     {7, -1.4},      {4.667, 1.4},  {-2.333, -4.2},  {-2, 4.2},     {15, -1.4},
     {10.333, 1.4}, {-1.333, -1.4}}};

VelodyneCalibration::PerLaserCalib laserAt(double elevation_deg, double azimuth_deg) {
    VelodyneCalibration::PerLaserCalib laser;
    laser.verticalCorrection = elevation_deg;
    laser.sinVertCorrection = portable::sin(mrpt::DEG2RAD(elevation_deg));
    laser.cosVertCorrection = portable::cos(mrpt::DEG2RAD(elevation_deg));
    laser.azimuthCorrection = -azimuth_deg;  // corrections are taken off the azimuth
    return laser;
}

VelodyneCalibration calibrationOf32C() {
    VelodyneCalibration calibration;
    for (const auto& [elevation_deg, azimuth_deg] : kLasersOf32C)
        calibration.laser_corrections.push_back(laserAt(elevation_deg, azimuth_deg));
    return calibration;
}

/** 16 lasers 4/3 deg apart that fire as those of a VLP-16 do: one of the lower half, one of the
 *  upper half. */
VelodyneCalibration calibrationOfHiRes() {
    VelodyneCalibration calibration;
    for (int pair = 0; pair < 8; ++pair)
        for (const double lowest_deg : {-10.0, 2.0 / 3})
            calibration.laser_corrections.push_back(laserAt(lowest_deg + pair * 4.0 / 3, 0));
    return calibration;
}

VelodyneCalibration usualCalibration(const std::string& name) {
    if (name == "VLP-32C") return calibrationOf32C();
    if (name == "Puck Hi-Res") return calibrationOfHiRes();
    // No two HDL-64E are alike, and MRPT 2.5.8 fails to read the one that it has.
    if (name == "HDL-64E") return {};
    return VelodyneCalibration::LoadDefaultCalibration(name == "VLP-16" ? "VLP16" : "HDL32");
}

/** MRPT's reader of YAML has no bounds of its own: what is nested deep ends the stack, and room is
 *  made for as many lasers as are claimed. */
bool mayBeCalibration(const std::string& yaml) {
    constexpr unsigned kMost = 1024;
    return YAML::LoadFile(yaml)["num_lasers"].as<unsigned>() <= kMost;
}

VelodyneCalibration readCalibration(const std::string& file) {
    if (!std::filesystem::is_regular_file(file))
        throw Error("there is no calibration '" + file + "'");
    VelodyneCalibration calibration;
    bool read = false;
    try {
        const std::string kind = std::filesystem::path(file).extension().string();
        // MRPT 2.5.8 takes the "text" of a YAML for its file's name, and so cannot read one either.
        read = kind == ".xml" ? calibration.loadFromXMLFile(file)
                              : mayBeCalibration(file) && (calibration.loadFromYAMLText(file) ||
                                                           calibration.loadFromYAMLFile(file));
    } catch (const std::exception&) {
        read = false;
    }
    if (!read || calibration.empty())
        throw Error("'" + file + "' is not a Velodyne's calibration (.xml or .yaml)");
    return calibration;
}

std::size_t lasersOf(const std::string& name) {
    if (name == "HDL-64E") return 64;
    return name == "VLP-32C" || name == "HDL-32E" ? 32 : 16;
}

const char* const kDecoded = "HDL-64E, HDL-32E, VLP-16, Puck Hi-Res and VLP-32C";

[[noreturn]] void refuse(const std::string& model) {
    throw Error("packets of a Velodyne " + model + " are not decoded, those of " + kDecoded +
                " are; give the clouds (PointCloud2) that its driver makes of them");
}
}  // namespace

std::string velodyneModelName(const std::uint8_t* packet) {
    constexpr std::size_t kBlocks = 12, kBlockBytes = 100, kFactoryByte = 1205;
    bool secondBank = false;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const std::uint8_t* const block = packet + kBlockBytes * b;
        if (block[0] != 0xFF) continue;
        if (block[1] == 0xCC || block[1] == 0xBB) refuse("VLS-128 (Alpha Prime)");
        secondBank = secondBank || block[1] == 0xDD;
    }
    // Its last two bytes tell its status in turn, not what it is.
    if (secondBank) return "HDL-64E";
    switch (packet[kFactoryByte]) {
        case 0x21:
            return "HDL-32E";
        case 0x22:
            return "VLP-16";
        case 0x23:
            refuse("VLP-32A or VLP-32B");
        case 0x24:
            return "Puck Hi-Res";
        case 0x28:
            return "VLP-32C";
        case 0x31:
            refuse("Velarray");
        case 0x63:
        case 0xA1:
            refuse("VLS-128 (Alpha Prime)");
        default:
            break;
    }
    std::array<char, 8> byte{};
    std::snprintf(byte.data(), byte.size(), "0x%02X", packet[kFactoryByte]);
    throw Error(std::string("a packet of a Velodyne that is not known (factory byte ") +
                byte.data() + "); " + kDecoded + " are");
}

VelodyneModel velodyneModel(const std::string& name, const std::string& calibrationFile) {
    VelodyneModel model;
    model.name = name;
    model.calibration =
        calibrationFile.empty() ? usualCalibration(name) : readCalibration(calibrationFile);
    const std::size_t lasers = model.calibration.laser_corrections.size();
    if (lasers == 0)
        throw Error("there is no usual calibration of a Velodyne " + name +
                    "; give the sensor's with --sensor-info");
    if (lasers != lasersOf(name))
        throw Error("the calibration '" + calibrationFile + "' is of " + std::to_string(lasers) +
                    " lasers, the packets are of a Velodyne " + name);
    model.layout.firing = firingTimes(lasers);
    if (name == "VLP-32C") {
        model.layout.firing = {2.304, 55.296, 2};
        model.layout.unit_m = 0.004;
    }
    return model;
}
}  // namespace delio::io
