#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <vector>

#include "core/portable_math.h"
#include "delio/core/error.h"
#include "findings.h"
#include "mrpt/clock.h"
#include "packet_decoder.h"
#include "turn_times.h"
#include "velodyne.h"

namespace delio::io {
namespace {
using Packet = mrpt::obs::CObservationVelodyneScan::TVelodyneRawPacket;
constexpr std::size_t kBlocks = 12, kBlockBytes = 100;
constexpr int kTurn = 36000;  // of azimuths, 0.01 deg
/** More packets than any revolution has, so that a stopped sensor does not fill the memory. */
constexpr std::size_t kMostPackets = 4000;

/** Turns begin where the azimuth passes 0, between two blocks. Its packet is part of both turns,
 *  each time with the blocks of the other one blanked. */
class VelodyneDecoder : public PacketDecoder {
 public:
    explicit VelodyneDecoder(std::string calibrationFile)
        : calibrationFile_(std::move(calibrationFile)) {}

    bool takes(std::size_t bytes) const override { return bytes == sizeof(Packet); }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override;
    std::optional<Scan> take() override;
    std::string sensor() const override {
        return model_.name.empty() ? "" : "Velodyne " + model_.name;
    }
    std::vector<std::string> findings() const override;

 private:
    /** Blocks `from` to before `to` of a packet are of this turn; the first one `turned` 0.01 deg
     *  after its begin. */
    void keep(const std::uint8_t* payload, std::size_t from, std::size_t to, double time_s,
              int turned);
    void endTurn(bool partial);
    /** Of each packet, from its first one on. */
    std::vector<double> startsOfPackets();

    std::string calibrationFile_;
    VelodyneModel model_;
    VelodyneClock clock_;
    std::vector<Packet> packets_;
    std::vector<double> times_s_;       //!< Unix time of each packet
    std::vector<double> places_;        //!< of each packet: part of a turn since the turn began
    int azimuth_ = -1;                  //!< of the last block
    int turned_ = 0;                    //!< since the turn began
    int turnedInAll_ = 0;               //!< in the turns before the first scan
    bool first_ = true;                 //!< the recording may begin within this turn
    std::size_t taken_ = 0, made_ = 0;  //!< packets, scans
    Happened mended_, untimed_;
    std::deque<Scan> scans_;
};

bool VelodyneDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    if (!takes(bytes)) throw Error("a Velodyne packet of " + std::to_string(bytes) + " bytes");
    const std::string name = velodyneModelName(payload);
    if (model_.name.empty()) model_ = velodyneModel(name, calibrationFile_);
    if (model_.name != name)
        throw Error("a packet of the Velodyne " + name + " is among packets of a " + model_.name);
    std::uint32_t clock_us = 0;
    std::memcpy(&clock_us, payload + kBlocks * kBlockBytes, sizeof(clock_us));
    const double time_s = clock_.timeOf(clock_us, received_s);
    ++taken_;
    std::size_t from = 0;
    int turned = turned_;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const std::uint8_t* const block = payload + kBlockBytes * b;
        const int azimuth = block[2] | block[3] << 8;
        if (azimuth >= kTurn) continue;
        if (azimuth_ >= 0 && azimuth < azimuth_ - kTurn / 2) {
            keep(payload, from, b, time_s, turned);
            endTurn(first_);
            first_ = false;
            from = b;
        } else if (azimuth_ >= 0) {
            turned_ += std::max(0, azimuth - azimuth_);
        }
        azimuth_ = azimuth;
        if (b == from) turned = turned_;
    }
    keep(payload, from, kBlocks, time_s, turned);
    if (packets_.size() >= kMostPackets) endTurn(false);
    return true;
}

void VelodyneDecoder::finish() {
    endTurn(true);
    if (taken_ == 0 || made_ > 0) return;
    throw Error("only " + std::to_string(turnedInAll_ / 100) + " of 360 degrees in " +
                std::to_string(taken_) + " packets of a " + sensor() +
                "; a scan needs at least half a revolution");
}

std::vector<std::string> VelodyneDecoder::findings() const {
    std::vector<std::string> findings;
    if (mended_.count > 0) findings.push_back(interpolatedTimes(mended_.of("packet")));
    if (untimed_.count > 0) findings.push_back(noTimes(untimed_.of("turn")));
    return findings;
}

void VelodyneDecoder::keep(const std::uint8_t* payload, std::size_t from, std::size_t to,
                           double time_s, int turned) {
    if (from == to) return;
    std::vector<std::uint8_t> bytes(payload, payload + sizeof(Packet));
    for (std::size_t b = 0; b < kBlocks; ++b)
        if (b < from || b >= to) bytes[kBlockBytes * b] = bytes[kBlockBytes * b + 1] = 0;
    packets_.emplace_back();
    std::memcpy(static_cast<void*>(&packets_.back()), bytes.data(), bytes.size());
    times_s_.push_back(time_s);
    places_.push_back(static_cast<double>(turned) / kTurn);
}

std::vector<double> VelodyneDecoder::startsOfPackets() {
    constexpr double kTolerance = 0.25;  // the times may be those of a recorder's clock
    std::vector<double> starts_s;
    for (const double time_s : times_s_) starts_s.push_back(time_s - times_s_.front());
    const auto mended = mendTurnTimes(places_, kTolerance, starts_s);
    if (mended && *mended > 0) mended_.add(*mended, made_);
    if (!mended) {
        untimed_.add(1, made_);
        starts_s.assign(starts_s.size(), 0);
    }
    return starts_s;
}

void VelodyneDecoder::endTurn(bool partial) {
    const bool enough = !packets_.empty() && (!partial || turned_ >= kTurn / 2);
    if (enough) {
        const std::vector<double> starts_s = startsOfPackets();
        ++made_;
        Scan scan;
        decodeVelodynePackets(packets_, starts_s, model_.calibration, model_.layout, scan);
        // The stamp is the first point's time, not that of the packet which it shares.
        const double lead_s = scan.times_s.empty() ? 0 : static_cast<double>(scan.times_s.front());
        for (float& time_s : scan.times_s) time_s -= static_cast<float>(lead_s);
        scan.stamp_s = times_s_.front() + lead_s;
        scan.time = timeOf(scan.stamp_s);
        scans_.push_back(std::move(scan));
    }
    packets_.clear();
    times_s_.clear();
    places_.clear();
    if (made_ == 0) turnedInAll_ += turned_;
    turned_ = 0;
}

std::optional<Scan> VelodyneDecoder::take() {
    if (scans_.empty()) return {};
    Scan scan = std::move(scans_.front());
    scans_.pop_front();
    return scan;
}
}  // namespace

std::unique_ptr<PacketDecoder> smallVelodyneDecoder(const std::string& calibrationFile) {
    return std::make_unique<VelodyneDecoder>(calibrationFile);
}

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
        throw Error("no such calibration file: '" + file + "'");
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
        throw Error("'" + file + "' is not a Velodyne calibration (.xml or .yaml)");
    return calibration;
}

std::size_t lasersOf(const std::string& name) {
    if (name == "HDL-64E") return 64;
    return name == "VLP-32C" || name == "HDL-32E" ? 32 : 16;
}

const char* const kDecoded = "HDL-64E, HDL-32E, VLP-16, Puck Hi-Res, VLP-32C and VLS-128";

[[noreturn]] void refuse(const std::string& model) {
    throw Error("packets of the Velodyne " + model + " are not supported (supported: " + kDecoded +
                "); record PointCloud2 messages with its driver instead");
}
}  // namespace

std::string velodyneModelName(const std::uint8_t* packet) {
    constexpr std::size_t kBlocks = 12, kBlockBytes = 100, kFactoryByte = 1205;
    if (isVls128(packet)) throw Error("a packet of a VLS-128 is among packets of another Velodyne");
    bool secondBank = false;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const std::uint8_t* const block = packet + kBlockBytes * b;
        if (block[0] != 0xFF) continue;
        secondBank = secondBank || block[1] == 0xDD;
    }
    // Its last two bytes cycle through status values and do not identify the model.
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
        default:
            break;
    }
    std::array<char, 8> byte{};
    std::snprintf(byte.data(), byte.size(), "0x%02X", packet[kFactoryByte]);
    throw Error(std::string("a packet of an unknown Velodyne (factory byte ") + byte.data() +
                "); supported are " + kDecoded);
}

VelodyneModel velodyneModel(const std::string& name, const std::string& calibrationFile) {
    VelodyneModel model;
    model.name = name;
    model.calibration =
        calibrationFile.empty() ? usualCalibration(name) : readCalibration(calibrationFile);
    const std::size_t lasers = model.calibration.laser_corrections.size();
    if (lasers == 0)
        throw Error("there is no standard calibration of the Velodyne " + name +
                    "; give the sensor's own with --sensor-info");
    if (lasers != lasersOf(name))
        throw Error("the calibration '" + calibrationFile + "' has " + std::to_string(lasers) +
                    " lasers but the packets come from a Velodyne " + name);
    model.layout.firing = firingTimes(lasers);
    if (name == "VLP-32C") {
        model.layout.firing = {2.304, 55.296, 2};
        model.layout.unit_m = 0.004;
    }
    return model;
}
}  // namespace delio::io
