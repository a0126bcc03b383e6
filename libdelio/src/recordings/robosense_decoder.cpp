#include <mrpt/core/bits_math.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <utility>
#include <vector>

#include "beam_angles.h"
#include "core/portable_math.h"
#include "delio/core/error.h"
#include "packet_bytes.h"
#include "packet_clock.h"
#include "packet_decoder.h"
#include "robosense.h"
#include "turn_builder.h"

namespace delio::io {
namespace {
constexpr double kTurn = 36000;  // of azimuths, 0.01 deg
constexpr std::size_t kBytes = 1248;

using Mark = std::array<std::uint8_t, 8>;
constexpr Mark kDescription{0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55};
constexpr Mark kOld{0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0};
constexpr std::array<std::uint8_t, 4> kNew{0x55, 0xAA, 0x05, 0x5A};

template <std::size_t kCount>
bool begins(const std::uint8_t* packet, const std::array<std::uint8_t, kCount>& with) {
    return std::equal(with.begin(), with.end(), packet);
}

/** A RoboSense and the layout of its packets; places are bytes from the packet's begin. */
struct Model {
    const char* name;
    std::size_t lasers, blocks;
    std::size_t bodyAt, blockBytes;
    std::size_t returnsAt;  //!< within a block, behind its azimuth
    std::size_t clockAt;    //!< of the seconds, or of the date
    bool hasDate;           //!< its clock is a date
    double unit_m;          //!< of distances
    double minRange, maxRange;
    double lens_m, height_m;     //!< where beams begin: from the axis, and along it
    double shot_s;               //!< from one azimuth to the next
    std::vector<float> laser_s;  //!< from there to each laser
};

std::vector<float> secondsOf(const std::vector<double>& microseconds) {
    std::vector<float> seconds;
    for (const double us : microseconds) seconds.push_back(static_cast<float>(1e-6 * us));
    return seconds;
}

/** User manuals of RS-Helios, RS-Bpearl and RS-Ruby Plus, and RoboSense's driver. */
const std::vector<double> kFiringOfHelios = {
    0,     1.57,  3.15,  4.72,  6.3,   7.87,  9.45,  11.36, 13.26, 15.17, 17.08,
    18.99, 20.56, 22.14, 23.71, 25.29, 26.53, 29.01, 27.77, 30.25, 31.49, 32.73,
    33.98, 35.22, 36.46, 37.7,  38.94, 40.18, 41.42, 42.67, 43.91, 45.15,
};
const std::vector<double> kFiringOfBpearl = {
    0,     2.56,  5.12,  7.68,  10.24, 12.8,  15.36, 17.92, 25.68, 28.24, 30.8,
    33.36, 35.92, 38.48, 41.04, 43.6,  1.28,  3.84,  6.4,   8.96,  11.52, 14.08,
    16.64, 19.2,  26.96, 29.52, 32.08, 34.64, 37.2,  39.76, 42.32, 44.88,
};

std::vector<double> firingOfNewBpearl() {
    std::vector<double> firing;
    for (int i = 0; i < 32; ++i) firing.push_back(51.71 / 31 * i);
    return firing;
}

/** Groups of lasers fire together. */
std::vector<double> firingOfRubyPlus() {
    const std::vector<std::pair<int, double>> groups{
        {4, 0},     {4, 1.13},  {4, 2.13},  {4, 3.26},  {4, 4.26},  {4, 5.38},  {4, 6.38},
        {4, 7.51},  {4, 8.51},  {4, 10.01}, {4, 11.38}, {4, 13.31}, {4, 15.11}, {4, 17.04},
        {4, 18.85}, {5, 21.14}, {4, 23.31}, {4, 25.61}, {4, 27.78}, {4, 30.07}, {4, 32.24},
        {4, 34.54}, {4, 36.7},  {4, 38.64}, {4, 40.44}, {4, 41.94}, {4, 43.3},  {4, 44.8},
        {4, 46.17}, {4, 47.66}, {4, 49.03}, {2, 50.53}, {1, 53.771}};
    std::vector<double> firing;
    for (const auto& [lasers, us] : groups) firing.insert(firing.end(), lasers, us);
    return firing;
}

const Model kHelios{"Helios", 32,      12,    42,       100,
                    4,        20,      false, 0.005,    0.1,
                    180,      0.03498, 0,     55.56e-6, secondsOf(kFiringOfHelios)};
const Model kBpearl{"Bpearl", 32,      12,      42,       100,
                    4,        20,      true,    0.005,    0.1,
                    150,      0.01473, 0.09427, 55.52e-6, secondsOf(kFiringOfBpearl)};
const Model kNewBpearl{"Bpearl 4.0", 32,       12,
                       42,           100,      4,
                       20,           false,    0.0025,
                       0.1,          150,      0.01619,
                       0.09571,      55.56e-6, secondsOf(firingOfNewBpearl())};
const Model kRubyPlus{"Ruby Plus", 128,     3,     80,       388,
                      4,           10,      false, 0.005,    0.4,
                      250,         0.02892, 0,     55.56e-6, secondsOf(firingOfRubyPlus())};

constexpr std::size_t kTypeAt = 30;

/** Blocks of a Ruby begin with one mark, those of the others with two. */
bool hasBlocks(const Model& model, const std::uint8_t* packet) {
    const std::uint8_t* const block = packet + model.bodyAt;
    return model.lasers == 128 ? block[0] == 0xFE : block[0] == 0xFF && block[1] == 0xEE;
}

[[noreturn]] void refuse(const std::uint8_t* packet) {
    throw Error("packets of a RoboSense of type " + std::to_string(packet[kTypeAt]) + "/" +
                std::to_string(packet[kTypeAt + 1]) + "/" + std::to_string(packet[kTypeAt + 2]) +
                " are not supported (supported: Helios, Bpearl and Ruby Plus); record PointCloud2 "
                "messages with its driver instead");
}

const Model& modelOf(const std::uint8_t* packet) {
    if (begins(packet, kOld)) {
        constexpr std::uint8_t kTypeOfBpearl = 3, kNewOne = 4;
        if (!hasBlocks(kBpearl, packet)) refuse(packet);
        if (packet[kTypeAt + 1] == kTypeOfBpearl && packet[kTypeAt + 2] == kNewOne)
            return kNewBpearl;
        if (packet[kTypeAt] == kTypeOfBpearl) return kBpearl;
    } else {
        if (hasBlocks(kHelios, packet)) return kHelios;
        if (hasBlocks(kRubyPlus, packet)) return kRubyPlus;
    }
    refuse(packet);
}

double clockOf(const Model& model, const std::uint8_t* packet) {
    const std::uint8_t* const at = packet + model.clockAt;
    if (!model.hasDate)
        return static_cast<double>(bigEndian(at, 6)) +
               1e-6 * static_cast<double>(bigEndian(at + 6, 4));
    std::tm time{};
    time.tm_year = at[0] + 100;
    time.tm_mon = at[1] - 1;
    time.tm_mday = at[2];
    time.tm_hour = at[3];
    time.tm_min = at[4];
    time.tm_sec = at[5];
    return static_cast<double>(timegm(&time)) + 1e-3 * static_cast<double>(bigEndian(at + 6, 2)) +
           1e-6 * static_cast<double>(bigEndian(at + 8, 2));
}

/** The angles in a description; empty where the sensor did not write them. */
std::vector<BeamAngles> anglesIn(const std::vector<std::uint8_t>& description, std::size_t lasers) {
    constexpr std::size_t kAt = 468, kAngle = 3;
    constexpr std::uint8_t kNone = 0xFF;
    constexpr double kSteepest_deg = 90, kWidest_deg = 180;
    std::vector<BeamAngles> angles;
    bool isFlat = true;
    const auto angleAt = [&](std::size_t at) {
        const double size_deg = 0.01 * static_cast<double>(bigEndian(&description[at + 1], 2));
        return description[at] == 0 ? size_deg : -size_deg;
    };
    for (std::size_t i = 0; i < lasers; ++i) {
        const std::size_t at = kAt + kAngle * i;
        const BeamAngles beam{angleAt(at), angleAt(at + kAngle * lasers)};
        if (description[at] == kNone || std::abs(beam.elevation_deg) > kSteepest_deg ||
            std::abs(beam.azimuth_deg) > kWidest_deg)
            return {};
        isFlat = isFlat && beam.elevation_deg == 0;
        angles.push_back(beam);
    }
    return isFlat ? std::vector<BeamAngles>{} : angles;
}

/** Rings are counted from the lowest one. */
std::vector<std::uint16_t> ringsOf(const std::vector<BeamAngles>& angles) {
    std::vector<std::uint16_t> rings;
    for (const BeamAngles& beam : angles)
        rings.push_back(static_cast<std::uint16_t>(std::count_if(
            angles.begin(), angles.end(),
            [&](const BeamAngles& other) { return other.elevation_deg < beam.elevation_deg; })));
    return rings;
}

/** Blocks that share an azimuth: the returns of one shot. */
struct Shot {
    std::size_t block = 0, returns = 1;
    double azimuth = 0;  //!< 0.01 deg
};

/** Beams leave the sensor beside its axis, and it turns on from laser to laser. x is ahead, at
 *  azimuth 0, and azimuths count clockwise. */
class RobosenseDecoder : public PacketDecoder {
 public:
    explicit RobosenseDecoder(std::string anglesFile) : anglesFile_(std::move(anglesFile)) {}

    bool takes(std::size_t bytes) const override { return bytes == kBytes; }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override;
    std::optional<Scan> take() override { return turns_.take(); }
    std::string sensor() const override {
        return model_ ? std::string("RoboSense ") + model_->name : "";
    }
    std::vector<std::string> findings() const override { return turns_.findings(); }

 private:
    bool findAngles();
    void decode(const std::uint8_t* packet, double received_s);
    std::vector<Shot> shotsOf(const std::uint8_t* packet) const;
    void addShot(const std::uint8_t* packet, const Shot& shot, double step);
    double unitOf(const std::uint8_t* packet) const;
    [[noreturn]] void lackAngles() const;

    std::string anglesFile_;
    const Model* model_ = nullptr;
    std::vector<std::uint8_t> description_;  //!< the last one; empty: none yet
    struct Waiting {
        std::vector<std::uint8_t> packet;
        double received_s;
    };
    std::vector<Waiting> waiting_;      //!< for the angles
    std::vector<BeamDirection> beams_;  //!< empty: the angles are not known yet
    std::vector<std::uint16_t> rings_;
    double sense_ = 1;  //!< -1: the sensor turns the other way
    double step_ = 20;  //!< usual one from shot to shot, 0.01 deg
    PacketClock clock_;
    TurnBuilder turns_;
};

void RobosenseDecoder::lackAngles() const {
    throw Error("the angles of the beams of the " + sensor() +
                " are not known; record its DIFOP packets as well, or give its angle.csv with "
                "--sensor-info");
}

/** False where they are not known yet. */
bool RobosenseDecoder::findAngles() {
    constexpr std::size_t kSenseAt = 337;
    if (!beams_.empty()) return true;
    std::vector<BeamAngles> angles;
    if (!anglesFile_.empty())
        angles = readBeamAngles(anglesFile_, model_->lasers);
    else if (!description_.empty())
        angles = anglesIn(description_, model_->lasers);
    if (angles.empty()) return false;
    const bool isBpearl = model_ == &kBpearl || model_ == &kNewBpearl;
    if (isBpearl && !description_.empty() && description_[kSenseAt] != 0) sense_ = -1;
    beams_ = directionsOf(angles);
    rings_ = ringsOf(angles);
    return true;
}

bool RobosenseDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    constexpr std::size_t kMostWaiting = 20'000;
    if (!isRobosensePacket(payload, bytes))
        throw Error("a packet of " + std::to_string(bytes) + " bytes of an unknown RoboSense");
    if (describesRobosense(payload, bytes)) {
        description_.assign(payload, payload + bytes);
        return true;
    }
    const Model& model = modelOf(payload);
    if (model_ && model_ != &model)
        throw Error(std::string("a packet of the RoboSense ") + model.name +
                    " is among packets of a " + model_->name);
    model_ = &model;
    if (!findAngles()) {
        if (waiting_.size() >= kMostWaiting) lackAngles();
        waiting_.push_back({{payload, payload + bytes}, received_s});
        return true;
    }
    for (const Waiting& earlier : std::exchange(waiting_, {}))
        decode(earlier.packet.data(), earlier.received_s);
    decode(payload, received_s);
    return true;
}

void RobosenseDecoder::finish() {
    if (model_ && !findAngles()) lackAngles();
    for (const Waiting& earlier : std::exchange(waiting_, {}))
        decode(earlier.packet.data(), earlier.received_s);
    turns_.finish(sensor());
}

std::vector<Shot> RobosenseDecoder::shotsOf(const std::uint8_t* packet) const {
    std::vector<Shot> shots;
    for (std::size_t b = 0; b < model_->blocks; ++b) {
        const std::uint8_t* const block = packet + model_->bodyAt + b * model_->blockBytes;
        const auto azimuth = static_cast<double>(bigEndian(block + 2, 2));
        if (block[0] != packet[model_->bodyAt] || azimuth >= kTurn) break;  // it was not filled
        if (!shots.empty() && shots.back().azimuth == azimuth)
            ++shots.back().returns;
        else
            shots.push_back({b, 1, azimuth});
    }
    return shots;
}

void RobosenseDecoder::decode(const std::uint8_t* packet, double received_s) {
    constexpr double kGap = 100;  // 0.01 deg: the sensor does not measure there
    const auto shots = shotsOf(packet);
    double time_s = clock_.timeOf(clockOf(*model_, packet), received_s);
    for (std::size_t i = 0; i < shots.size(); ++i) {
        const double turn = i + 1 < shots.size()
                                ? std::fmod(shots[i + 1].azimuth - shots[i].azimuth + kTurn, kTurn)
                                : step_;
        const bool isGap = turn > kGap;
        if (!isGap) step_ = turn;
        turns_.block(sense_ * shots[i].azimuth / kTurn, time_s);
        addShot(packet, shots[i], step_);
        time_s += model_->shot_s * (isGap ? turn / step_ : 1);
    }
}

double RobosenseDecoder::unitOf(const std::uint8_t* packet) const {
    constexpr std::size_t kAt = 17;  // 1: half the usual one
    return model_ == &kHelios && packet[kAt] == 1 ? model_->unit_m / 2 : model_->unit_m;
}

void RobosenseDecoder::addShot(const std::uint8_t* packet, const Shot& shot, double step) {
    const std::uint8_t* const block = packet + model_->bodyAt + shot.block * model_->blockBytes;
    const double unit_m = unitOf(packet);
    portable::SineAndCosine turned{};
    for (std::size_t laser = 0; laser < model_->lasers; ++laser) {
        const float after_s = model_->laser_s[laser];
        if (laser == 0 || after_s != model_->laser_s[laser - 1]) {
            const double share = static_cast<double>(after_s) / model_->shot_s;
            turned = portable::sineAndCosine(sense_ *
                                             mrpt::DEG2RAD(0.01 * (shot.azimuth + step * share)));
        }
        const auto [sine, cosine] = turned;
        const BeamDirection& beam = beams_[laser];
        const double side = sense_ * beam.sine;
        std::uint64_t earlier = 0;
        for (std::size_t r = 0; r < shot.returns; ++r) {
            const std::uint8_t* const measured =
                block + r * model_->blockBytes + model_->returnsAt + 3 * laser;
            const std::uint64_t distance = bigEndian(measured, 2);
            const double range = unit_m * static_cast<double>(distance);
            // A return that only repeats the one before does not count.
            if (distance == 0 || distance == earlier || range < model_->minRange ||
                range > model_->maxRange)
                continue;
            earlier = distance;
            const double flat = range * beam.cosineUp;
            const double ahead = flat * (cosine * beam.cosine - sine * side),
                         right = flat * (sine * beam.cosine + cosine * side);
            turns_.add({static_cast<float>(ahead + model_->lens_m * cosine),
                        static_cast<float>(-right - model_->lens_m * sine),
                        static_cast<float>(range * beam.sineUp + model_->height_m),
                        static_cast<float>(measured[2]) / 255.0F, rings_[laser], after_s});
        }
    }
}
}  // namespace

bool describesRobosense(const std::uint8_t* packet, std::size_t bytes) {
    return bytes == kBytes && begins(packet, kDescription);
}

bool isRobosensePacket(const std::uint8_t* packet, std::size_t bytes) {
    return bytes == kBytes &&
           (begins(packet, kOld) || begins(packet, kNew) || begins(packet, kDescription));
}

std::unique_ptr<PacketDecoder> robosenseDecoder(const std::string& anglesFile) {
    return std::make_unique<RobosenseDecoder>(anglesFile);
}
}  // namespace delio::io
