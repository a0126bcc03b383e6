#include <array>
#include <cstdio>
#include <ctime>

#include <mrpt/core/bits_math.h>

#include "core/portable_math.h"
#include "delio/core/error.h"
#include "forwarding_decoder.h"
#include "hesai.h"
#include "hesai_at128.h"
#include "packet_bytes.h"
#include "packet_clock.h"
#include "turn_builder.h"

namespace delio::io {
std::size_t returnsOfHesai(std::uint8_t mode) {
    switch (mode) {
        case 0x33:
        case 0x34:
        case 0x37:
        case 0x38:
            return 1;
        case 0x39:
        case 0x3a:
        case 0x3b:
        case 0x3c:
        case 0x3e:
            return 2;
        case 0x3d:
            return 3;
        default:
            break;
    }
    std::array<char, 8> byte{};
    std::snprintf(byte.data(), byte.size(), "0x%02X", mode);
    throw Error(std::string("a Hesai packet with the unknown return mode ") + byte.data());
}

namespace {
constexpr double kTurn = 36000;  // of azimuths, 0.01 deg

/** Seconds of the sensor's clock: Unix time where it was set. Years count from 1900, or from 2000
 *  where they would be too early. */
double clockOf(const HesaiModel& model, const std::uint8_t* packet) {
    const std::uint8_t* const date = packet + model.dateAt;
    std::tm time{};
    time.tm_year = date[0] < 70 ? date[0] + 100 : date[0];
    time.tm_mon = date[1] - 1;
    time.tm_mday = date[2];
    time.tm_hour = date[3];
    time.tm_min = date[4];
    time.tm_sec = date[5];
    return static_cast<double>(timegm(&time)) +
           1e-6 * static_cast<double>(littleEndian(packet + model.clockAt, 4));
}

/** Points lie in Hesai's frame: azimuths count clockwise from y, z is up. */
class HesaiDecoder : public PacketDecoder {
 public:
    explicit HesaiDecoder(std::string anglesFile) : anglesFile_(std::move(anglesFile)) {}

    bool takes(std::size_t bytes) const override { return isHesaiSize(bytes); }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override;
    void finish() override { turns_.finish(sensor()); }
    std::optional<Scan> take() override { return turns_.take(); }
    std::string sensor() const override { return model_ ? "Hesai " + model_->name : ""; }
    std::vector<std::string> findings() const override { return turns_.findings(); }

 private:
    void start(const HesaiModel& model);
    /** The blocks from `b` on, one a return, that share an azimuth. */
    void addGroup(const std::uint8_t* packet, std::size_t b, std::size_t returns, double time_s);
    const std::vector<float>& firing(const std::uint8_t* packet, std::size_t b, std::size_t returns,
                                     bool isFine) const;
    double unitOf(const std::uint8_t* packet) const;
    std::size_t blockBytes() const {
        return model_->azimuthAt + 2 + model_->lasers * model_->returnBytes;
    }

    std::string anglesFile_;
    const HesaiModel* model_ = nullptr;
    std::vector<BeamDirection> beams_;
    /** From a block's time to its lasers': of the two times that `other_ns` tells apart, each as it
     *  is and of the state with `fine_ns`. */
    std::array<std::vector<float>, 4> after_s_;
    PacketClock clock_;
    TurnBuilder turns_;
};

void HesaiDecoder::start(const HesaiModel& model) {
    if (model_ == &model) return;
    if (model_)
        throw Error("a packet of the Hesai " + model.name + " is among packets of a " +
                    model_->name);
    beams_ = directionsOf(anglesFile_.empty() ? model.angles
                                              : readBeamAngles(anglesFile_, model.lasers));
    model_ = &model;
    const HesaiFiring& firing = model.firing;
    for (std::size_t i = 0; i < after_s_.size(); ++i)
        for (const int ns : i < 2 || firing.other_ns.empty() ? firing.laser_ns : firing.other_ns)
            after_s_[i].push_back(1e-9F * static_cast<float>(i % 2 == 1 && firing.fine_ns > 0
                                                                 ? ns % firing.fine_ns
                                                                 : ns));
}

bool HesaiDecoder::add(const std::uint8_t* payload, std::size_t bytes, double received_s) {
    const HesaiModel* const model = hesaiModel(payload, bytes);
    if (!model) throw Error("a packet of " + std::to_string(bytes) + " bytes of an unknown Hesai");
    start(*model);
    const std::size_t returns = returnsOfHesai(payload[model->modeAt]);
    const double time_s = clock_.timeOf(clockOf(*model, payload), received_s);
    for (std::size_t b = 0; b + returns <= model->blocks; b += returns)
        addGroup(payload, b, returns, time_s);
    return true;
}

const std::vector<float>& HesaiDecoder::firing(const std::uint8_t* packet, std::size_t b,
                                               std::size_t returns, bool isFine) const {
    const bool isOther = returns == 1 ? b % 2 == 1 : (packet[model_->loopAt] & 1U) == 0;
    return after_s_[(isOther ? 2 : 0) + (isFine ? 1 : 0)];
}

double HesaiDecoder::unitOf(const std::uint8_t* packet) const {
    constexpr int kUsual_mm = 4;
    const int unit_mm = model_->unitAt == 0 ? kUsual_mm : packet[model_->unitAt];
    if (unit_mm == 0) throw Error("a packet of the Hesai " + model_->name + " has no unit");
    return 1e-3 * unit_mm;
}

void HesaiDecoder::addGroup(const std::uint8_t* packet, std::size_t b, std::size_t returns,
                            double time_s) {
    const std::size_t step = blockBytes();
    const std::uint8_t* const block = packet + model_->bodyAt + b * step;
    const double azimuth = littleEndian(block + model_->azimuthAt, 2);
    if (azimuth > kTurn) return;  // a block that was not filled
    const HesaiFiring& times = model_->firing;
    const auto before = static_cast<int>(b / returns);
    const auto behind = static_cast<int>((model_->blocks - 1 - b) / returns);
    const bool isFine = times.fine_ns > 0 && packet[model_->stateAt] == 0;
    const int next_ns = isFine ? times.fine_ns : times.next_ns;
    const int block_ns = times.block_ns + next_ns * (times.ofLast ? -behind : before);
    turns_.block(azimuth / kTurn, time_s + 1e-9 * block_ns);
    const double angle = mrpt::DEG2RAD(0.01 * azimuth), unit_m = unitOf(packet);
    const auto [sine, cosine] = portable::sineAndCosine(angle);
    const auto& after_s = firing(packet, b, returns, isFine);
    for (std::size_t laser = 0; laser < model_->lasers; ++laser) {
        const BeamDirection& beam = beams_[laser];
        std::uint32_t earlier = 0;
        for (std::size_t r = 0; r < returns; ++r) {
            const std::uint8_t* const measured =
                block + r * step + model_->azimuthAt + 2 + laser * model_->returnBytes;
            const std::uint32_t distance = littleEndian(measured, 2);
            const double range = unit_m * distance;
            // A return that only repeats the one before does not count.
            if (distance == 0 || distance == earlier || range < model_->minRange ||
                range > model_->maxRange)
                continue;
            earlier = distance;
            const double flat = range * beam.cosineUp;
            turns_.add({static_cast<float>(flat * (sine * beam.cosine + cosine * beam.sine)),
                        static_cast<float>(flat * (cosine * beam.cosine - sine * beam.sine)),
                        static_cast<float>(range * beam.sineUp),
                        static_cast<float>(measured[2]) / 255.0F, static_cast<std::uint16_t>(laser),
                        after_s[laser]});
        }
    }
}
/** Takes the first packet's kind for that of all. */
class AnyHesai : public ForwardingDecoder {
 public:
    explicit AnyHesai(std::string anglesFile) : anglesFile_(std::move(anglesFile)) {}

    bool takes(std::size_t bytes) const override { return isHesaiSize(bytes); }
    bool add(const std::uint8_t* payload, std::size_t bytes, double received_s) override {
        if (!decoder_ && isAt128(payload, bytes))
            decoder_ = at128Decoder(anglesFile_);
        else if (!decoder_)
            decoder_ = std::make_unique<HesaiDecoder>(anglesFile_);
        return decoder_->add(payload, bytes, received_s);
    }

 private:
    std::string anglesFile_;
};
}  // namespace

std::unique_ptr<PacketDecoder> hesaiDecoder(const std::string& anglesFile) {
    return std::make_unique<AnyHesai>(anglesFile);
}
}  // namespace delio::io
