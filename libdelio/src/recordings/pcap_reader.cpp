#include "sources.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "delio/core/error.h"
#include "delio/files/output.h"
#include "ouster.h"
#include "ouster_http.h"
#include "packet_decoder.h"
#include "robosense.h"
#include "udp_stream.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
std::string textOf(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error("'" + file.string() + "' cannot be opened");
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string addressText(std::uint32_t address) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8)
        text += std::to_string(address >> shift & 255U) + (shift > 0 ? "." : "");
    return text;
}

/** Identifies a sensor among others of its kind: source and destination of its packets. */
struct Sender {
    std::string kind;
    std::uint16_t port = 0;
    std::uint32_t address = 0;

    bool operator==(const Sender& other) const {
        return kind == other.kind && port == other.port && address == other.address;
    }
    std::string withPort() const { return kind + ":" + std::to_string(port); }
    std::string inFull() const { return withPort() + "@" + addressText(address); }
    bool matches(const std::string& label) const {
        return label.empty() || label == std::to_string(port) || label == kind ||
               label == withPort() || label == inFull() || label == addressText(address);
    }
};

class PcapReader : public ScanReader {
 public:
    PcapReader(const ScanSource& source, std::shared_ptr<PacketSource> packets);

    std::optional<Scan> next() override;
    bool skip() override { return next().has_value(); }
    std::vector<ImuSample> takeImu() override { return decoder_->takeImu(); }
    const std::string& label() const override { return label_; }
    const std::set<std::string>& otherLabels() const override { return others_; }
    std::optional<double> fraction() const override { return packets_->fraction(); }
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override;

 private:
    std::string named() const {
        return source_.path == "-" ? "standard input" : "'" + source_.path + "'";
    }
    /** Whose packet it is, if a LiDAR's. */
    std::optional<Sender> senderOf(const UdpPacket& packet) const;
    /** `packet`: its first one; none: not read yet. */
    void makeDecoder(const std::string& kind, const UdpPacket& packet);
    void askOuster(std::uint32_t address);
    /** Reads on until the decoder was given a packet of its sensor; false at the end. */
    bool feed();
    bool give(const std::string& kind, const UdpPacket& packet);
    bool add(const std::string& kind, const UdpPacket& packet);
    void passOver(const std::string& other);
    bool takeImuOf(const UdpPacket& packet);
    void keepDescription(const UdpPacket& packet);
    void finish();

    ScanSource source_;
    std::shared_ptr<PacketSource> packets_;
    std::unique_ptr<PacketDecoder> decoder_;
    std::optional<Sender> sender_;
    std::string label_;
    std::set<std::string> others_;
    std::map<std::string, std::size_t> passedOver_;  //!< packets of others; "": of no LiDAR
    double latest_s_ = 0, before_s_ = 0;  //!< times of the two latest packets that were taken
    std::size_t refused_ = 0;             //!< packets that the decoder does not understand
    std::string refusal_;                 //!< why the first of these
    /** Of the RoboSense of an address: these packets come to another port than the others. */
    std::map<std::uint32_t, std::vector<std::uint8_t>> descriptions_;
    struct Asked {
        std::string json, refusal;  //!< one of them is empty
    };
    std::map<std::uint32_t, Asked> asked_;  //!< Ousters by address
    std::optional<DriveMeta> meta_;
    std::string foundJson_;      //!< beside the recording, under another name
    std::uint16_t imuPort_ = 0;  //!< 0: no packet of an IMU was met
    std::size_t count_ = 0;
    bool isOuster_ = false, pointTimes_ = false, ended_ = false;
    std::string fault_;  //!< fault that ended the recording, reported after the scans before it
};

PcapReader::PcapReader(const ScanSource& source, std::shared_ptr<PacketSource> packets)
    : source_(source), packets_(std::move(packets)) {
    // A json can be of nothing but an Ouster, and says how long its packets are.
    if (fs::path(source_.sensorFile).extension() == ".json") makeDecoder("ouster", {});
    const bool any = feed();
    if (any) return;
    if (!fault_.empty()) throw Error(fault_);
    std::string seen;
    for (const std::string& other : others_) seen += (seen.empty() ? "" : ", ") + other;
    throw Error((packets_->isLive() ? "no packets came to " + named() + " of "
                                    : named() + " contains no packets of ") +
                (source_.label.empty() ? "a Velodyne, Ouster, Hesai or RoboSense"
                                       : "the sensor '" + source_.label + "'") +
                (decoder_ ? " that match '" + source_.sensorFile + "'" : "") +
                (seen.empty() ? "" : "; there are packets of " + seen));
}

std::optional<Sender> PcapReader::senderOf(const UdpPacket& packet) const {
    const std::string maker = makerOf(packet.payload, packet.bytes);
    if (!maker.empty()) return Sender{maker, packet.toPort, packet.from};
    if (decoder_ ? isOuster_ && decoder_->takes(packet.bytes) : isOusterPacketSize(packet.bytes))
        return Sender{"ouster", packet.toPort, packet.from};
    return {};
}

void PcapReader::makeDecoder(const std::string& kind, const UdpPacket& packet) {
    if (kind != "ouster") {
        decoder_ = decoderFor(kind, source_.sensorFile);
        if (const auto known = descriptions_.find(packet.from); known != descriptions_.end())
            decoder_->add(known->second.data(), known->second.size(), packet.time_s);
        return;
    }
    isOuster_ = true;
    if (source_.sensorFile.empty()) {
        if (packets_->isLive()) return askOuster(packet.from);
        if (source_.path == "-")
            throw Error("packets of an Ouster need the sensor's json (--sensor-info)");
        source_.sensorFile = ousterJsonBeside(source_.path, packet.payload, packet.bytes).name;
        const fs::path json = source_.sensorFile;
        if (json.stem() != fs::path(source_.path).stem()) foundJson_ = json.filename().string();
    }
    decoder_ = ousterDecoder(textOf(source_.sensorFile), source_.sensorFile);
}

/** Gets the json of a live Ouster from it, once, and keeps it beside the recording. */
void PcapReader::askOuster(std::uint32_t address) {
    constexpr std::size_t kMost = 4;  // sensors: addresses may be made up
    const bool isKnown = asked_.count(address) > 0;
    if (!isKnown && asked_.size() >= kMost) throw Error("too many Ousters send packets");
    auto& [json, refusal] = asked_[address];
    try {
        if (!refusal.empty()) throw Error(refusal);
        if (!isKnown) json = ousterJsonFrom(address, source_.live.sensorHttpPort);
        decoder_ = ousterDecoder(json, "http://" + addressText(address));
    } catch (const Error& e) {
        refusal = e.what();
        throw Error("packets of an Ouster need the sensor's json: give it with --sensor-info; " +
                    refusal);
    }
    if (isKnown) return;
    if (source_.live.record.empty()) return;
    const std::string beside = fs::path(source_.live.record).replace_extension(".json");
    try {
        replaceTextFile(beside, [&text = json](std::ostream& out) { out << text; });
    } catch (const Error& e) {
        if (source_.live.onWarning)
            source_.live.onWarning(std::string(e.what()) + "; it is needed to read the recording");
    }
}

void PcapReader::finish() {
    try {
        if (decoder_) decoder_->finish();
    } catch (const Error& e) {
        if (fault_.empty()) fault_ = named() + ": " + e.what();
    }
}

/** Hands a packet to the decoder. One that it does not understand is left out, unless there are no
 *  others. */
bool PcapReader::add(const std::string& kind, const UdpPacket& packet) {
    constexpr std::size_t kMost = 1000;
    try {
        if (!decoder_) makeDecoder(kind, packet);
        return decoder_->add(packet.payload, packet.bytes, packet.time_s);
    } catch (const Error& e) {
        if (refused_++ == 0) refusal_ = e.what();
        const bool isNone = !sender_ && (refused_ >= kMost || (!decoder_ && !packets_->isLive()));
        if (isNone) throw Error(named() + ": " + e.what());
        if (!sender_ && source_.sensorFile.empty()) {  // another sensor may follow
            decoder_.reset();
            isOuster_ = false;
        }
        return false;
    }
}

/** False where it is of another sensor. */
bool PcapReader::give(const std::string& kind, const UdpPacket& packet) {
    const bool taken = add(kind, packet);
    if (taken) before_s_ = std::exchange(latest_s_, packet.time_s);
    if (!taken || meta_ || decoder_->sensor().empty()) return taken;
    meta_.emplace();
    const std::string sensor = decoder_->sensor();
    const auto space = sensor.find(' ');
    meta_->sensorModel = space == std::string::npos ? sensor : sensor.substr(space + 1);
    meta_->source = "pcap";
    meta_->motionCompensated = false;
    return taken;
}

/** True for a packet of the sensor's IMU, from the same address. */
bool PcapReader::takeImuOf(const UdpPacket& packet) {
    if (!sender_ || packet.from != sender_->address) return false;
    if (!decoder_->addImu(packet.payload, packet.bytes)) return false;
    imuPort_ = packet.toPort;
    return true;
}

void PcapReader::keepDescription(const UdpPacket& packet) {
    constexpr std::size_t kMost = 64;  // sensors
    if (sender_) {
        if (sender_->kind == "robosense" && sender_->address == packet.from)
            give(sender_->kind, packet);
    } else if (descriptions_.size() < kMost) {
        descriptions_[packet.from].assign(packet.payload, packet.payload + packet.bytes);
    }
}

/** `other`: its sender, if it is a LiDAR's. */
void PcapReader::passOver(const std::string& other) {
    constexpr std::size_t kMost = 64;  // senders: addresses may be made up
    const bool isKnown = passedOver_.count(other) > 0;
    if (!isKnown && passedOver_.size() >= kMost) return passOver("");
    ++passedOver_[other];
    if (!other.empty()) others_.insert(other);
}

bool PcapReader::feed() {
    while (!ended_) {
        std::optional<UdpPacket> packet;
        try {
            packet = packets_->next();
            if (packet && takeImuOf(*packet)) continue;
            if (packet && describesRobosense(packet->payload, packet->bytes)) {
                keepDescription(*packet);
                continue;
            }
            const auto sender = packet ? senderOf(*packet) : std::nullopt;
            if (packet && !sender) {
                passOver("");
                continue;
            }
            const bool wanted =
                sender && (sender_ ? *sender == *sender_
                                   : sender->matches(source_.label) &&
                                         (!decoder_ || decoder_->takes(packet->bytes)));
            if (packet && !wanted) {
                passOver(sender_ && sender->withPort() == sender_->withPort() ? sender->inFull()
                                                                              : sender->withPort());
                continue;
            }
            if (packet) {
                if (!give(sender->kind, *packet)) continue;
                if (!sender_) label_ = source_.label.empty() ? sender->kind : sender->withPort();
                sender_ = sender;
                return true;
            }
        } catch (const Error& e) {
            fault_ = e.what();
        }
        ended_ = true;
        finish();
        if (!sender_ && fault_.empty() && refused_ > 0) fault_ = named() + ": " + refusal_;
    }
    return false;
}

std::optional<Scan> PcapReader::next() {
    while (true) {
        if (auto scan = decoder_->take()) {
            scan->index = count_++;
            pointTimes_ = pointTimes_ || !scan->times_s.empty();
            // The packet that ends a turn may be the next turn's first one.
            packets_->endScan(scan->index,
                              ended_ || decoder_->endedWhole() ? latest_s_ : before_s_);
            return scan;
        }
        if (!fault_.empty()) {
            const Error fault(fault_);
            fault_.clear();
            throw fault;
        }
        if (ended_) return {};
        feed();
    }
}

Recording PcapReader::recording() const {
    Recording recording;
    recording.kind = "pcap" + (foundJson_.empty() ? "" : ", metadata '" + foundJson_ + "'");
    recording.sensor = decoder_->sensor();
    recording.pointTimes = pointTimes_;
    recording.motionCompensated = false;
    if (packets_->isLive()) recording.kind = source_.path;
    recording.findings = decoder_->findings();
    if (refused_ > 0)
        recording.findings.push_back("packets that are not understood were ignored: " +
                                     std::to_string(refused_) + " (first: " + refusal_ + ")");
    for (const auto& [sender, count] : passedOver_)
        if (packets_->isLive())
            recording.findings.push_back("packets of " +
                                         (sender.empty() ? "no supported LiDAR" : sender) +
                                         " were ignored: " + std::to_string(count));
    if (imuPort_ != 0) recording.imu = "at port " + std::to_string(imuPort_);
    return recording;
}
}  // namespace

std::unique_ptr<ScanReader> openPcap(const ScanSource& source) {
    return openPackets(source, std::make_shared<UdpStream>(source.path));
}

std::unique_ptr<ScanReader> openPackets(const ScanSource& source,
                                        std::shared_ptr<PacketSource> packets) {
    return std::make_unique<PcapReader>(source, std::move(packets));
}
}  // namespace delio::io
