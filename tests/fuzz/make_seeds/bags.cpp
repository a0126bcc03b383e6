#include "at128_packets.h"
#include "bag_files.h"
#include "fast_spinner.h"
#include "osf_writer.h"
#include "ouster_packets.h"
#include "rosette.h"
#include "seeds.h"
#include "spinning_packets.h"

namespace delio::fuzz {
namespace {
void bags() {
    using Kind = test::WireWriter::Kind;
    const auto ros1 = bag_test::drive(2), cdr = bag_test::drive(2, Kind::kCdr);
    for (const char* packing : {"none", "bz2", "lz4"})
        test::writeRos1Bag(seed("ros1_bag", packing), ros1, packing);
    test::writeRos1Bag(seed("ros1_bag", "never"), ros1, "none", test::Index::kNever);
    for (const char* packing : {"", "lz4", "zstd"})
        test::writeMcap(seed("mcap", std::string("cdr") + packing), cdr, packing);
    test::writeMcap(seed("mcap", "plain"), ros1, "", test::Index::kWritten, 0);
    test::writeMcap(seed("mcap", "never"), cdr, "", test::Index::kNever);
    test::writeDatabase(seed("database", "cdr"), cdr);
    const test::TemporaryFolder folder;
    test::writeMetadata(folder.path(), cdr, {"bag_0.mcap"});
    writeText(seed("bag_folder", "metadata"), readText(folder / "metadata.yaml"));
}

/** A Hesai's packet with more than a turn: its azimuths lie 60 deg apart. */
test::Bytes hesaiPacket(const test::HesaiToy& toy) {
    auto fast = toy;
    fast.step = 6000;
    return test::hesaiPacket(fast, 0, 1700000000);
}

test::Bytes robosensePacket(const test::RobosenseToy& toy) {
    auto fast = toy;
    fast.step = 6000;
    return test::robosensePacket(fast, 0, 1700000000);
}

void otherMessages() {
    using Kind = test::WireWriter::Kind;
    const auto packet = hesaiPacket(test::hesaiToys()[2]);
    const std::string hesai(packet.begin(), packet.end());
    test::RosetteDrive drive;
    drive.pointsPerSecond = 100;
    for (const auto& [digit, kind] : {std::pair{"0", Kind::kRos1}, {"1", Kind::kCdr}}) {
        const std::string name = digit;
        drive.kind = kind;
        writeText(seed("messages", "livox" + name), "3" + name + livoxMessage(drive, 0, 0.1));
        test::WireWriter pandar(kind), nebula(kind), frame(kind), robosense(kind);
        pandar.header(1000).number(std::uint32_t{1}).time(1000);
        pandar.bytes(hesai).bytes(std::string(1500 - hesai.size(), ' '));
        pandar.number(static_cast<std::uint32_t>(hesai.size()));
        writeText(seed("messages", "pandar" + name), "4" + name + pandar.message());
        nebula.header(1000).number(std::uint32_t{1}).time(1000).byteArray(hesai);
        writeText(seed("messages", "nebula" + name), "5" + name + nebula.message());
        frame.header(1000).number(std::uint32_t{1}).byteArray(hesai);
        frame.number(static_cast<std::uint32_t>(hesai.size()));
        writeText(seed("messages", "frame" + name), "6" + name + frame.message());
        const auto description = test::robosenseDescription(test::robosenseToys()[0]);
        robosense.header(1000).number(std::uint8_t{1}).number(std::uint8_t{0});
        robosense.byteArray({description.begin(), description.end()});
        writeText(seed("messages", "robosense" + name), "8" + name + robosense.message());
    }
}

/** Two packets of each model that tells itself; those of a RoboSense behind its description. */
void otherPackets() {
    const auto timed = [](const test::Bytes& packet) {
        std::string text = "d";
        text += static_cast<char>(packet.size() & 0xFFU);
        text += static_cast<char>(packet.size() >> 8);
        return text.append(packet.begin(), packet.end());
    };
    const std::string noTable = std::string("0") + '\0';
    auto hesai = test::hesaiToys();
    hesai.push_back(test::hesai128Toy(true));
    for (const auto& toy : hesai) {
        const std::string packet = timed(hesaiPacket(toy));
        writeText(seed("packets", toy.name), noTable + packet + packet);
        writeText(seed("packets", "table" + toy.name),
                  "1" + test::toyAngles(toy.lasers) + '\0' + packet);
    }
    for (const auto& toy : test::robosenseToys()) {
        const std::string packet = timed(robosensePacket(toy));
        writeText(seed("packets", toy.name),
                  noTable + timed(test::robosenseDescription(toy)) + packet + packet);
    }
    std::string at128 = "0";
    for (int field = 0; field < 2; ++field) {
        const auto packet = test::at128Packet(field, 100, 1.7e9);
        at128.append(packet.begin(), packet.end());
    }
    writeText(seed("at128", "packets"), at128);
    writeText(seed("at128", "file"), "1" + test::at128File());
    auto bank = velodynePacket();
    for (std::size_t b = 0; b < 12; ++b)
        bank[100 * b + 1] = static_cast<std::uint8_t>(0xEE - 0x11 * (b % 4));
    writeText(seed("packets", "vls128"), noTable + timed(bank) + timed(bank));
}

void messages() {
    using Kind = test::WireWriter::Kind;
    const auto packet = velodynePacket();
    for (const auto& [digit, kind] : {std::pair{"0", Kind::kRos1}, {"1", Kind::kCdr}}) {
        const std::string name = digit;
        writeText(seed("messages", "cloud" + name), "0" + name + test::cloudMessage({}, kind));
        test::WireWriter scan(kind), beams(kind);
        scan.header(1000).number(std::uint32_t{1}).time(1000);
        scan.bytes({packet.begin(), packet.end()});
        writeText(seed("messages", "velodyne" + name), "1" + name + scan.message());
        beams.byteArray(std::string(64 + 16 * 20, '\1'));
        writeText(seed("messages", "ouster" + name), "2" + name + beams.message());
    }
    otherMessages();
    test::CloudSpec rows;
    rows.rows = 2;
    rows.padding = 3;
    rows.bigEndian = true;
    writeText(seed("messages", "rows"), "01" + test::cloudMessage(rows, Kind::kCdrBigEndian));
}

/** An Ouster of 16 rows whose turn is of four packets. */
std::string ousterJson(const std::string& profile) {
    auto json = test::OusterToy{profile}.json();
    json["data_format"]["columns_per_frame"] = 16;
    json["data_format"]["columns_per_packet"] = 4;
    json["lidar_mode"] = "512x10";
    return json.dump();
}

test::Bytes ousterPacket(const std::string& profile, std::uint16_t frame, std::uint16_t first) {
    const test::OusterToy toy{profile};
    const std::size_t head = toy.legacy() ? 0 : 32, columnHead = toy.legacy() ? 16 : 12;
    const std::size_t column = columnHead + 16 * toy.pixel() + (toy.legacy() ? 4 : 0);
    test::Bytes bytes(2 * head + 4 * column);
    if (!toy.legacy()) test::putAt(bytes, toy.safety() ? 4 : 2, frame);
    for (std::uint16_t c = 0; c < 4; ++c) {
        const std::size_t at = head + c * column;
        test::putAt(bytes, at, toy.start_ns + (16ULL * frame + first + c) * 1000000);
        test::putAt(bytes, at + 8, static_cast<std::uint16_t>(first + c));
        test::putAt(bytes, at + 10, toy.legacy() ? frame : std::uint16_t{1});
        if (toy.legacy()) test::putAt(bytes, at + column - 4, 0xFFFFFFFFU);
        for (std::size_t row = 0; row < 16; ++row)
            toy.putPixel(bytes, at + columnHead + row * toy.pixel());
    }
    return bytes;
}

void packets() {
    const auto velodyne = velodynePacket();
    const std::string turn(velodyne.begin(), velodyne.end());
    writeText(seed("velodyne", "vlp16"), "0" + kNul + "d" + turn + "d" + turn + "d" + turn);
    writeText(seed("velodyne", "yaml"),
              "1lasers:\n- {azimuth: 0, dist_correction: 0, dist_correction_x: 0, "
              "dist_correction_y: 0, focal_distance: 0, focal_slope: 0, horiz_offset_correction: "
              "0, laser_id: 0, min_intensity: 0, max_intensity: 255, rot_correction: 0, "
              "vert_correction: 0, vert_offset_correction: 0}\nnum_lasers: 1\n" +
                  kNul + "d" + turn);
    writeText(seed("velodyne", "xml"),
              "2<?xml version=\"1.0\"?><boost_serialization><DB><enabled_>"
              "</enabled_></DB></boost_serialization>" +
                  kNul + "d" + turn);
    test::PcapWriter pcap;
    for (int i = 0; i < 3; ++i) pcap.add(velodyne, 1000 + 0.1 * i);
    behind(kNul, seed("pcap", "velodyne"),
           [&](const fs::path& file) { pcap.write(file.string()); });
    for (const std::string profile : {"LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG15_RFL8_NIR8",
                                      "RNG19_RFL8_SIG16_NIR16_DUAL", "FUSA_RNG15_RFL8_NIR8_DUAL"}) {
        const std::string json = ousterJson(profile);
        std::string bytes;
        test::PcapWriter ouster;
        for (std::uint16_t i = 0; i < 6; ++i) {
            const auto packet = ousterPacket(profile, static_cast<std::uint16_t>(i / 4),
                                             static_cast<std::uint16_t>(i % 4 * 4));
            bytes.append(packet.begin(), packet.end());
            ouster.add(packet, 1000 + 0.1 * i);
        }
        writeText(seed("ouster", profile), json + kNul + bytes);
        behind(json + kNul, seed("pcap", profile),
               [&](const fs::path& file) { ouster.write(file.string()); });
    }
    test::PcapWriter fragments;
    fragments.mtu = 576;
    fragments.add(velodyne, 1000);
    behind(kNul, seed("pcap", "fragments"),
           [&](const fs::path& file) { fragments.write(file.string()); });
}

/** Three samples of an IMU, as fields of a turn. */
std::vector<test::FlatTree> imuFields(test::FieldCoding coding) {
    constexpr std::uint32_t kHalf = 0x3F000000;  // 0.5 as a float
    const std::string vectors =
        test::codedField(coding, 3, 3, 4, std::vector<std::uint32_t>(9, kHalf));
    const auto field = [](const std::string& name, const std::string& data) {
        return test::FlatTree().bytes(0, name).bytes(4, data);
    };
    return {field("IMU_ACC", vectors), field("IMU_GYRO", vectors),
            field("IMU_STATUS", std::string("\1\0\0\0\1\0", 6)),
            field("IMU_TIMESTAMP", std::string(24, '\1'))};
}

/** Two turns of it in Ouster's own format. */
void osf() {
    const std::string profile = "RNG19_RFL8_SIG16_NIR16";
    auto json = nlohmann::json::parse(ousterJson(profile));
    json["data_format"]["pixel_shift_by_row"] = std::vector<int>(16, 3);
    const auto info = io::readOusterInfo(json.dump(), "toy.json");
    for (const auto& [name, coding] :
         {std::pair{"png", test::FieldCoding::kPng}, {"zpng", test::FieldCoding::kZpng}}) {
        test::OsfSensor sensor{json.dump(), {}};
        for (std::uint16_t number = 0; number < 2; ++number) {
            io::OusterFrame frame(info);
            frame.number = number;
            for (std::uint16_t first = 0; first < 16; first += 4) {
                const auto bytes = ousterPacket(profile, number, first);
                const io::OusterPacket packet(info, bytes.data());
                for (std::size_t c = 0; c < 4; ++c) packet.copyTo(frame, c);
            }
            sensor.turns.push_back(
                test::osfTurn(info, frame, coding, 1'000'000'000).tables(8, imuFields(coding)));
        }
        writeText(seed("osf", name), test::osfFile({sensor}));
    }
}

/** .bin files of records with rings and times. */
void binLayouts() {
    std::string boreas, avia, nclt;
    for (int i = 0; i < 40; ++i) {
        const auto x = static_cast<float>(i);
        const float boreasPoint[6]{x, 2, 3, 0.5F, static_cast<float>(i % 8), 1e-3F * x};
        boreas.append(reinterpret_cast<const char*>(boreasPoint), sizeof(boreasPoint));
        avia.append(reinterpret_cast<const char*>(boreasPoint), 12);
        const std::uint8_t numbers[7]{
            9, 0, static_cast<std::uint8_t>(i % 6), 0, static_cast<std::uint8_t>(i), 0, 0};
        avia.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
        const std::uint16_t nclts[4]{20000, static_cast<std::uint16_t>(21000 + i), 19000,
                                     static_cast<std::uint16_t>(i % 32 << 8)};
        nclt.append(reinterpret_cast<const char*>(nclts), sizeof(nclts));
    }
    writeText(seed("clouds", "boreas"), "2" + boreas);
    writeText(seed("clouds", "avia"), "2" + avia);
    writeText(seed("clouds", "nclt"), "2" + nclt);
}
}  // namespace

void seedBags() {
    osf();
    binLayouts();
    bags();
    messages();
    otherPackets();
    packets();
}
}  // namespace delio::fuzz
