#include "hesai_at128.h"

#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/portable_math.h"
#include "delio/core/error.h"
#include "files/input_file.h"
#include "hesai.h"
#include "packet_bytes.h"
#include "packet_clock.h"
#include "turn_builder.h"

namespace delio::io {
namespace {
constexpr double kFine_deg = 1.0 / 25600;  // unit of angles
constexpr std::size_t kTableSteps = 180;   // of 2 deg

/** Nanoseconds from the block's time to each laser. */
constexpr std::array<int, kAt128Lasers> kFiring_ns{
    0,     0,     8240,  4112,  4144,  8240,  0,     0,     12424, 4144,  4112,  8264,  12376,
    12376, 8264,  12424, 0,     0,     4112,  8240,  4144,  0,     0,     4144,  12424, 8264,
    4112,  12376, 12376, 12424, 8264,  848,   2504,  4976,  6616,  6616,  9112,  2504,  848,
    10768, 13280, 13280, 4976,  9112,  14928, 14928, 10768, 2504,  848,   6616,  4976,  9112,
    6616,  848,   2504,  13280, 10768, 4976,  13280, 14928, 9112,  10768, 14928, 13280, 848,
    9112,  13280, 2504,  4976,  848,   2504,  14928, 10768, 10768, 14928, 4976,  6616,  6616,
    9112,  848,   13280, 13280, 9112,  4976,  2504,  2504,  848,   10768, 14928, 14928, 10768,
    6616,  4976,  9112,  6616,  4112,  12424, 0,     4144,  0,     0,     12424, 0,     8264,
    4112,  4144,  8240,  8240,  8264,  12376, 12376, 12424, 4112,  4144,  0,     0,     0,
    0,     0,     12424, 8264,  8240,  4144,  8264,  8240,  12376, 12376, 8264};

/** Places are bytes from the packet's begin. */
constexpr std::size_t kBody = 12, kBlocks = 2, kReturn = 4, kReturnsAt = 3,
                      kBlock = kReturnsAt + kAt128Lasers * kReturn,
                      kTail = kBody + kBlocks * kBlock + 4, kClockAt = kTail + 20,
                      kModeAt = kTail + 24, kSecondsAt = kTail + 27, kEnd = kTail + 32;

double signedAt(const std::uint8_t* bytes) {
    return static_cast<double>(static_cast<std::int32_t>(littleEndian(bytes, 4)));
}
}  // namespace

At128Angles::At128Angles(const std::string& file) {
    constexpr std::size_t kHead = 16, kMostFields = 8;
    if (file.empty())
        throw Error(
            "a Hesai AT128 needs its own angles: give its correction file (--sensor-info "
            "FILE.dat)");
    const auto bytes = bytesOfFile(file);
    const auto refuse = [&](const std::string& why) {
        throw Error("'" + file + "' is not a correction file of an AT128: " + why);
    };
    if (bytes.size() < kHead || bytes[0] != 0xEE || bytes[1] != 0xFF) refuse("it begins otherwise");
    if (bytes[2] != 1 || bytes[3] != 5)
        refuse("version " + std::to_string(bytes[2]) + "." + std::to_string(bytes[3]) +
               ", not 1.5");
    const std::size_t fields = bytes[5];
    if (bytes[4] != kAt128Lasers || fields == 0 || fields > kMostFields || bytes[15] == 0)
        refuse("its counts are wrong");
    const std::size_t table = kAt128Lasers * kTableSteps;
    if (bytes.size() < kHead + 8 * fields + 8 * kAt128Lasers + 2 * table) refuse("it is cut off");
    const double unit_deg = kFine_deg * bytes[15];
    const std::uint8_t* at = bytes.data() + kHead;
    for (auto* const angles : {&starts_, &ends_})
        for (std::size_t i = 0; i < fields; ++i, at += 4)
            angles->push_back(unit_deg * littleEndian(at, 4));
    for (auto& laser : lasers_) {
        laser.azimuth = unit_deg * signedAt(at);
        laser.elevation = unit_deg * signedAt(at + 4 * kAt128Lasers);
        at += 4;
    }
    at += 4 * kAt128Lasers;
    unit_deg_ = 0.01 * bytes[15];
    moreAzimuth_.assign(at, at + table);
    moreElevation_.assign(at + table, at + 2 * table);
}

double At128Angles::withinField(double mirror_deg, std::size_t& field) const {
    for (field = 0; field < starts_.size(); ++field) {
        const auto from = [](double start, double to) {
            const double turned = std::fmod(to - start, 360.0);
            return turned < 0 ? turned + 360 : turned;
        };
        const double within = from(starts_[field], mirror_deg);
        if (within <= from(starts_[field], ends_[field])) return within;
    }
    return -1;
}

At128Angles::Direction At128Angles::direction(std::size_t field, double mirror_deg,
                                              std::size_t laser) const {
    constexpr double kStep_deg = 2;
    const double steps = mirror_deg / kStep_deg;
    const auto before = static_cast<std::size_t>(steps);
    const double part = steps - static_cast<double>(before);
    const std::size_t row = laser * kTableSteps, i = row + before % kTableSteps,
                      next = row + (before + 1) % kTableSteps;
    const auto more = [&](const std::vector<std::int8_t>& table) {
        return unit_deg_ * ((1 - part) * table[i] + part * table[next]);
    };
    // The mirror turns the beam by twice its own angle.
    return {2 * (mirror_deg - starts_[field]) - lasers_[laser].azimuth + more(moreAzimuth_),
            lasers_[laser].elevation + more(moreElevation_)};
}

namespace {
/** Each field of the mirror is a scan of the directions in front of the sensor. */
class At128Decoder : public PacketDecoder {
 public:
    explicit At128Decoder(const std::string& anglesFile) : angles_(anglesFile) {}

    bool takes(std::size_t bytes) const override { return isAt128Size(bytes); }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override { turns_.finish(sensor()); }
    std::optional<Scan> take() override { return turns_.take(); }
    std::string sensor() const override { return "Hesai AT128"; }
    std::vector<std::string> findings() const override { return turns_.findings(); }

 private:
    /** The blocks from `block` on, one a return, share an azimuth. */
    void addGroup(const std::uint8_t* block, std::size_t returns, double unit_m, double time_s);

    At128Angles angles_;
    PacketClock clock_;
    TurnBuilder turns_;
};

bool At128Decoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    constexpr int kFirst_ns = -9249, kNext_ns = 41666;
    if (!isAt128(payload, bytes))
        throw Error("a packet of another sensor is among packets of a Hesai AT128");
    const std::size_t returns = returnsOfHesai(payload[kModeAt]);
    const double unit_m = 1e-3 * payload[9];
    const double clock_s = static_cast<double>(bigEndian(payload + kSecondsAt, 5)) +
                           1e-6 * littleEndian(payload + kClockAt, 4);
    const double time_s = clock_.timeOf(clock_s, received_s);
    for (std::size_t b = 0; b + returns <= kBlocks; b += returns) {
        const auto behind = static_cast<int>((kBlocks - b) / returns);
        addGroup(payload + kBody + b * kBlock, returns, unit_m,
                 time_s + 1e-9 * (kFirst_ns - kNext_ns * behind));
    }
    return true;
}

void At128Decoder::addGroup(const std::uint8_t* block, std::size_t returns, double unit_m,
                            double time_s) {
    constexpr double kNear = 1, kFar = 180, kTurn_deg = 360;
    // The beams sweep from 30 to 150 deg; the part of that is the part of the scan.
    constexpr double kBegin_deg = 25, kSweep_deg = 130;
    const double mirror_deg =
        kFine_deg * (256.0 * littleEndian(block, 2) + static_cast<double>(block[2]));
    std::size_t field = 0;
    const double within_deg = angles_.withinField(mirror_deg, field);
    const double place = (2 * within_deg - kBegin_deg) / kSweep_deg;
    if (mirror_deg >= kTurn_deg || within_deg < 0 || place < 0 || place >= 1) return;
    turns_.block(place, time_s);
    for (std::size_t laser = 0; laser < kAt128Lasers; ++laser) {
        std::optional<At128Angles::Direction> beam;
        std::uint32_t earlier = 0;
        for (std::size_t r = 0; r < returns; ++r) {
            const std::uint8_t* const measured = block + r * kBlock + kReturnsAt + laser * kReturn;
            const std::uint32_t distance = littleEndian(measured, 2);
            const double range = unit_m * distance;
            if (distance == earlier || range < kNear || range > kFar) continue;
            earlier = distance;
            if (!beam) beam = angles_.direction(field, mirror_deg, laser);
            const auto up = portable::sineAndCosine(mrpt::DEG2RAD(beam->elevation)),
                       across = portable::sineAndCosine(mrpt::DEG2RAD(beam->azimuth));
            const double flat = range * up.cosine;
            turns_.add(
                {static_cast<float>(flat * across.sine), static_cast<float>(flat * across.cosine),
                 static_cast<float>(range * up.sine), static_cast<float>(measured[2]) / 255.0F,
                 static_cast<std::uint16_t>(laser), 1e-9F * static_cast<float>(kFiring_ns[laser])});
        }
    }
}
}  // namespace

bool isAt128Size(std::size_t bytes) {
    constexpr std::size_t kSum = 4, kNumber = 4, kSignature = 32;
    for (const std::size_t number : {std::size_t{0}, kNumber})
        for (const std::size_t signature : {std::size_t{0}, kSignature})
            if (bytes == kEnd + kSum + number + signature) return true;
    return false;
}

bool isAt128(const std::uint8_t* packet, std::size_t bytes) {
    constexpr std::uint8_t kMajor = 4, kMinor = 3;
    return isAt128Size(bytes) && packet[0] == 0xEE && packet[1] == 0xFF && packet[2] == kMajor &&
           packet[3] == kMinor && packet[6] == kAt128Lasers && packet[7] == kBlocks;
}

std::unique_ptr<PacketDecoder> at128Decoder(const std::string& anglesFile) {
    return std::make_unique<At128Decoder>(anglesFile);
}
}  // namespace delio::io
