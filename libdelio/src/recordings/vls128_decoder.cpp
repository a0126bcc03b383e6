#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "beam_angles.h"
#include "core/portable_math.h"
#include "delio/core/error.h"
#include "forwarding_decoder.h"
#include "packet_bytes.h"
#include "turn_builder.h"
#include "velodyne.h"

namespace delio::io {
namespace {
constexpr double kTurn = 36000;  // of azimuths, 0.01 deg
constexpr std::size_t kBytes = 1206, kBlocks = 12, kBlockBytes = 100, kBankLasers = 32;

/** Elevation and azimuth offset (clockwise) of each laser in degrees, in the order of firing:
 * VLS-128 User Manual. */
const std::vector<BeamAngles> kAngles = {
    {-11.742, 6.354}, {-1.99, 4.548},  {3.4, 2.732},      {-5.29, 0.911},  {-0.78, -0.911},
    {4.61, -2.732},   {-4.08, -4.548}, {1.31, -6.354},    {-6.5, 6.354},   {-1.11, 4.548},
    {4.28, 2.732},    {-4.41, 0.911},  {0.1, -0.911},     {6.48, -2.732},  {-3.2, -4.548},
    {2.19, -6.354},   {-3.86, 6.354},  {1.53, 4.548},     {-9.244, 2.732}, {-1.77, 0.911},
    {2.74, -0.911},   {-5.95, -2.732}, {-0.56, -4.548},   {4.83, -6.354},  {-2.98, 6.354},
    {2.41, 4.548},    {-6.28, 2.732},  {-0.89, 0.911},    {3.62, -0.911},  {-5.07, -2.732},
    {0.32, -4.548},   {7.58, -6.354},  {-0.34, 6.354},    {5.18, 4.548},   {-3.64, 2.732},
    {1.75, 0.911},    {-25.0, -0.911}, {-2.43, -2.732},   {2.96, -4.548},  {-5.73, -6.354},
    {0.54, 6.354},    {9.7, 4.548},    {-2.76, 2.732},    {2.63, 0.911},   {-7.65, -0.911},
    {-1.55, -2.732},  {3.84, -4.548},  {-4.85, -6.354},   {3.18, 6.354},   {-5.51, 4.548},
    {-0.12, 2.732},   {5.73, 0.911},   {-4.3, -0.911},    {1.09, -2.732},  {-16.042, -4.548},
    {-2.21, -6.354},  {4.06, 6.354},   {-4.63, 4.548},    {0.76, 2.732},   {15.0, 0.911},
    {-3.42, -0.911},  {1.97, -2.732},  {-6.85, -4.548},   {-1.33, -6.354}, {-5.62, 6.354},
    {-0.23, 4.548},   {5.43, 2.732},   {-3.53, 0.911},    {0.98, -0.911},  {-19.582, -2.732},
    {-2.32, -4.548},  {3.07, -6.354},  {-4.74, 6.354},    {0.65, 4.548},   {11.75, 2.732},
    {-2.65, 0.911},   {1.86, -0.911},  {-7.15, -2.732},   {-1.44, -4.548}, {3.95, -6.354},
    {-2.1, 6.354},    {3.29, 4.548},   {-5.4, 2.732},     {-0.01, 0.911},  {4.5, -0.911},
    {-4.19, -2.732},  {1.2, -4.548},   {-13.565, -6.354}, {-1.22, 6.354},  {4.17, 4.548},
    {-4.52, 2.732},   {0.87, 0.911},   {6.08, -0.911},    {-3.31, -2.732}, {2.08, -4.548},
    {-6.65, -6.354},  {1.42, 6.354},   {-10.346, 4.548},  {-1.88, 2.732},  {3.51, 0.911},
    {-6.06, -0.911},  {-0.67, -2.732}, {4.72, -4.548},    {-3.97, -6.354}, {2.3, 6.354},
    {-6.39, 4.548},   {-1.0, 2.732},   {4.39, 0.911},     {-5.18, -0.911}, {0.21, -2.732},
    {6.98, -4.548},   {-3.09, -6.354}, {4.98, 6.354},     {-3.75, 4.548},  {1.64, 2.732},
    {-8.352, 0.911},  {-2.54, -0.911}, {2.85, -2.732},    {-5.84, -4.548}, {-0.45, -6.354},
    {8.43, 6.354},    {-2.87, 4.548},  {2.52, 2.732},     {-6.17, 0.911},  {-1.66, -0.911},
    {3.73, -2.732},   {-4.96, -4.548}, {0.43, -6.354},
};

/** Eight lasers fire at once, every 2.665 us, with one pause after half of them. */
constexpr double kGroup_us = 2.665, kCycle_us = 53.3, kFirst_us = -8.7;
constexpr std::size_t kGroup = 8, kHalf = 64;

double afterBegin_us(std::size_t laser) {
    return kGroup_us * static_cast<double>(laser / kGroup + laser / kHalf);
}

/** The bank of 32 lasers that a block is of, by its second byte. */
std::optional<std::size_t> bankOf(const std::uint8_t* block) {
    constexpr std::array<std::uint8_t, 4> kMarks{0xEE, 0xDD, 0xCC, 0xBB};
    const auto* const mark = std::find(kMarks.begin(), kMarks.end(), block[1]);
    if (block[0] != 0xFF || mark == kMarks.end()) return {};
    return static_cast<std::size_t>(mark - kMarks.begin());
}

int azimuthOf(const std::uint8_t* block) { return static_cast<int>(littleEndian(block + 2, 2)); }

class Vls128Decoder : public PacketDecoder {
 public:
    explicit Vls128Decoder(const std::string& anglesFile)
        : beams_(directionsOf(anglesFile.empty() ? kAngles
                                                 : readBeamAngles(anglesFile, kAngles.size()))) {}

    bool takes(std::size_t bytes) const override { return bytes == kBytes; }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override { turns_.finish(sensor()); }
    std::optional<Scan> take() override { return turns_.take(); }
    std::string sensor() const override { return "Velodyne VLS-128"; }
    std::vector<std::string> findings() const override { return turns_.findings(); }

 private:
    /** `count` blocks from `blocks` on share an azimuth: a firing of all lasers. */
    void addFiring(const std::uint8_t* blocks, std::size_t count, double time_s);
    void addBlock(const std::uint8_t* block, const std::uint8_t* first, std::size_t bank);

    std::vector<BeamDirection> beams_;
    VelodyneClock clock_;
    TurnBuilder turns_;
    int azimuth_ = -1;  //!< of the last firing
    int step_ = 20;     //!< usual one from firing to firing, 0.01 deg
};

bool Vls128Decoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    if (!takes(bytes) || !isVls128(payload))
        throw Error("a packet of another sensor is among packets of a VLS-128");
    const double packet_s =
        clock_.timeOf(littleEndian(payload + kBlocks * kBlockBytes, 4), received_s);
    std::size_t firing = 0;
    for (std::size_t b = 0; b < kBlocks;) {
        const std::uint8_t* const block = payload + b * kBlockBytes;
        if (!bankOf(block) || azimuthOf(block) >= kTurn) break;  // it was not filled
        std::size_t count = 1;
        while (b + count < kBlocks && bankOf(block + count * kBlockBytes) &&
               azimuthOf(block + count * kBlockBytes) == azimuthOf(block))
            ++count;
        const double from_us = kFirst_us + kCycle_us * static_cast<double>(firing++);
        addFiring(block, count, packet_s + 1e-6 * from_us);
        b += count;
    }
    return true;
}

void Vls128Decoder::addFiring(const std::uint8_t* blocks, std::size_t count, double time_s) {
    constexpr int kMostStep = 100;
    const int azimuth = azimuthOf(blocks);
    const int step = azimuth - azimuth_;
    if (azimuth_ >= 0 && step > 0 && step < kMostStep) step_ = step;
    azimuth_ = azimuth;
    turns_.block(azimuth / kTurn, time_s);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint8_t* const block = blocks + i * kBlockBytes;
        const std::uint8_t* first = nullptr;  // block with the first returns of second ones
        for (std::size_t k = 0; k < i; ++k)
            if (blocks[k * kBlockBytes + 1] == block[1]) first = blocks + k * kBlockBytes;
        addBlock(block, first, *bankOf(block));
    }
}

void Vls128Decoder::addBlock(const std::uint8_t* block, const std::uint8_t* first,
                             std::size_t bank) {
    constexpr double kUnit_m = 0.004, kNear = 0.5, kFar = 300;
    constexpr std::size_t kReturn = 3, kReturnsAt = 4;
    std::array<portable::SineAndCosine, kBankLasers / kGroup> turned{};
    std::array<double, kBankLasers / kGroup> after_us{};
    // The sensor turns on from group to group.
    for (std::size_t g = 0; g < turned.size(); ++g) {
        after_us[g] = afterBegin_us(bank * kBankLasers + g * kGroup);
        const double azimuth = azimuthOf(block) + step_ * after_us[g] / kCycle_us;
        turned[g] = portable::sineAndCosine(mrpt::DEG2RAD(0.01 * azimuth));
    }
    for (std::size_t k = 0; k < kBankLasers; ++k) {
        const std::size_t at = kReturnsAt + kReturn * k, laser = bank * kBankLasers + k;
        const std::uint32_t distance = littleEndian(block + at, 2);
        const double range = kUnit_m * distance;
        if (range < kNear || range > kFar || (first && littleEndian(first + at, 2) == distance))
            continue;
        const auto [sine, cosine] = turned[k / kGroup];
        const BeamDirection& beam = beams_[laser];
        const double flat = range * beam.cosineUp;
        turns_.add({static_cast<float>(flat * (cosine * beam.cosine - sine * beam.sine)),
                    static_cast<float>(-flat * (sine * beam.cosine + cosine * beam.sine)),
                    static_cast<float>(range * beam.sineUp),
                    static_cast<float>(block[at + 2]) / 255.0F, static_cast<std::uint16_t>(laser),
                    static_cast<float>(1e-6 * after_us[k / kGroup])});
    }
}

/** Takes the first packet's model for that of all. */
class AnyVelodyne : public ForwardingDecoder {
 public:
    explicit AnyVelodyne(std::string sensorFile) : sensorFile_(std::move(sensorFile)) {}

    bool takes(std::size_t bytes) const override { return bytes == kBytes; }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override {
        if (!takes(bytes)) throw Error("a Velodyne packet of " + std::to_string(bytes) + " bytes");
        if (!decoder_ && isVls128(payload))
            decoder_ = std::make_unique<Vls128Decoder>(sensorFile_);
        else if (!decoder_)
            decoder_ = smallVelodyneDecoder(sensorFile_);
        return decoder_->add(payload, bytes, received_s);
    }

 private:
    std::string sensorFile_;
};
}  // namespace

bool isVls128(const std::uint8_t* packet) {
    constexpr std::size_t kFactoryByte = 1205;
    for (std::size_t b = 0; b < kBlocks; ++b) {
        const auto bank = bankOf(packet + b * kBlockBytes);
        if (bank && *bank >= 2) return true;
    }
    return packet[kFactoryByte] == 0x63 || packet[kFactoryByte] == 0xA1;
}

std::unique_ptr<PacketDecoder> velodyneDecoder(const std::string& calibrationFile) {
    return std::make_unique<AnyVelodyne>(calibrationFile);
}
}  // namespace delio::io
