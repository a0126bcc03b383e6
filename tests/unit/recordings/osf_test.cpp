// Ouster's own format, against the packets of the same turns.
#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cstring>

#include "delio/core/error.h"
#include "osf_writer.h"
#include "ouster_packets.h"
#include "recordings/field_image.h"
#include "recordings/packet_decoder.h"
#include "recordings/sources.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::Bytes;
using test::FieldCoding;
using test::FlatTree;
using test::OusterToy;
using test::putAt;
constexpr double kNow_s = 1600000000;
constexpr std::size_t kPackets = 32;

std::string jsonOf(const OusterToy& toy) {
    auto json = toy.json();
    std::vector<int> shifts;
    for (int row = 0; row < 16; ++row) shifts.push_back(row % 2 ? 4 : -4);
    json["data_format"]["pixel_shift_by_row"] = shifts;
    return json.dump();
}

/** A packet in which each pixel has another range and reflectivity, and some have none. */
Bytes packetOf(const OusterToy& toy, std::uint16_t frame, std::size_t i) {
    Bytes packet = toy.packet(frame, i);
    for (std::size_t c = 0; c < 16; ++c)
        for (std::size_t row = 0; row < 16; ++row) {
            const std::size_t pixel = 32 + 204 * c + 12 + 12 * row, place = 16 * i + c;
            const bool isNone = (place + row) % 7 == 0;
            putAt(packet, pixel,
                  static_cast<std::uint32_t>(isNone ? 0 : 3000 + 129 * place + 17 * row + frame));
            packet[pixel + 4] = static_cast<std::uint8_t>(place + 3 * row);
        }
    return packet;
}

/** Turn 3 ends behind its middle. */
bool isSent(std::uint16_t frame, std::size_t i) { return frame != 3 || i < kPackets / 2 + 3; }

std::vector<Scan> scansOfPackets(const OusterToy& toy, std::uint16_t turns) {
    const auto decoder = io::ousterDecoder(jsonOf(toy), "toy.json");
    std::vector<Scan> scans;
    for (std::uint16_t frame = 0; frame < turns; ++frame)
        for (std::size_t i = 0; i < kPackets; ++i) {
            if (!isSent(frame, i)) continue;
            const Bytes packet = packetOf(toy, frame, i);
            decoder->add(packet.data(), packet.size(), kNow_s + 0.1 * frame);
        }
    decoder->finish();
    while (auto scan = decoder->take()) scans.push_back(std::move(*scan));
    return scans;
}

test::OsfSensor sensorOf(const OusterToy& toy, FieldCoding coding, std::uint16_t turns) {
    test::OsfSensor sensor{jsonOf(toy), {}};
    const auto info = io::readOusterInfo(sensor.json, "toy.json");
    for (std::uint16_t number = 0; number < turns; ++number) {
        io::OusterFrame frame(info);
        frame.number = number;
        for (std::size_t i = 0; i < kPackets; ++i) {
            const Bytes bytes = packetOf(toy, number, i);
            const io::OusterPacket packet(info, bytes.data());
            for (std::size_t c = 0; c < 16 && isSent(number, i); ++c) packet.copyTo(frame, c);
        }
        sensor.turns.push_back(test::osfTurn(
            info, frame, coding, static_cast<std::uint64_t>(1e9 * (kNow_s + 0.1 * number))));
    }
    return sensor;
}

void expectSame(const Scan& one, const Scan& other) {
    const auto& a = dynamic_cast<const mrpt::maps::CPointsMapXYZI&>(*one.points);
    const auto& b = dynamic_cast<const mrpt::maps::CPointsMapXYZI&>(*other.points);
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.getPointsBufferRef_x(), b.getPointsBufferRef_x());
    EXPECT_EQ(a.getPointsBufferRef_y(), b.getPointsBufferRef_y());
    EXPECT_EQ(a.getPointsBufferRef_z(), b.getPointsBufferRef_z());
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_EQ(a.getPointIntensity(i), b.getPointIntensity(i)) << i;
    EXPECT_EQ(one.rings, other.rings);
    EXPECT_EQ(one.times_s, other.times_s);
    EXPECT_NEAR(one.stamp_s, other.stamp_s, 1e-6);
}

class Osf : public testing::Test {
 protected:
    std::string write(const std::string& bytes) const {
        test::writeText(folder_ / "d.osf", bytes);
        return (folder_ / "d.osf").string();
    }
    std::string faultOf(const std::string& bytes, const std::string& label = "") const {
        try {
            const auto reader = io::openScans({write(bytes), label, "", ""});
            while (reader->next()) {
            }
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            return e.what();
        }
        return "";
    }
    test::TemporaryFolder folder_;
};

TEST_F(Osf, ScansAreThoseOfThePackets) {
    OusterToy toy;
    toy.serial = 992137000142;
    for (const FieldCoding coding : {FieldCoding::kPng, FieldCoding::kZpng}) {
        const auto expected = scansOfPackets(toy, 4);
        ASSERT_EQ(expected.size(), 4U);
        const auto reader = io::openScans(write(test::osfFile({sensorOf(toy, coding, 4)})));
        EXPECT_EQ(io::describe(reader->recording()),
                  "Ouster OS-1-16, 10 Hz, points with times, not de-skewed by the recorder (OSF)");
        EXPECT_EQ(reader->label(), "992137000142");
        for (const Scan& scan : expected) {
            const auto read = reader->next();
            ASSERT_TRUE(read);
            expectSame(*read, scan);
        }
        EXPECT_FALSE(reader->next());
        EXPECT_GT(reader->fraction().value_or(0), 0.9);
    }
}

TEST_F(Osf, OneOfTwoSensors) {
    OusterToy front, rear;
    front.serial = 5;
    rear.serial = 6;
    const std::string both = test::osfFile(
        {sensorOf(front, FieldCoding::kPng, 2), sensorOf(rear, FieldCoding::kZpng, 3)});
    for (const auto& [label, scans] : {std::pair{"", 2}, {"5", 2}, {"6", 3}}) {
        const auto reader = io::openScans({write(both), label, "", ""});
        int read = 0;
        while (reader->next()) ++read;
        EXPECT_EQ(read, scans);
        EXPECT_EQ(reader->otherLabels().size(), 1U);
    }
    EXPECT_NE(faultOf(both, "7").find("no sensor '7'; it contains 5, 6"), std::string::npos);
}

TEST_F(Osf, DamageIsNamed) {
    const std::string good = test::osfFile({sensorOf(OusterToy(), FieldCoding::kPng, 3)});
    EXPECT_EQ(faultOf(good), "");
    EXPECT_NE(faultOf(good.substr(0, good.size() / 2)).find("is cut off at byte"),
              std::string::npos);
    std::string damaged = good;
    damaged[good.size() / 2] = static_cast<char>(damaged[good.size() / 2] ^ 1);
    EXPECT_NE(faultOf(damaged).find("wrong checksum"), std::string::npos);
    EXPECT_NE(faultOf(test::osfFile({{jsonOf(OusterToy()), {}}})).find("contains no scan"),
              std::string::npos);
    EXPECT_NE(faultOf("no OSF").find("is not an OSF file"), std::string::npos);
    // The scans before the damage are read.
    const auto reader = io::openScans(write(damaged));
    EXPECT_TRUE(reader->next());
    EXPECT_THROW(while (reader->next()){}, Error);
    EXPECT_FALSE(reader->next());
}

TEST_F(Osf, WhatIsNotATurnIsRefused) {
    const OusterToy toy;
    auto sensor = sensorOf(toy, FieldCoding::kPng, 1);
    const auto faultWith = [&](const FlatTree& turn) {
        sensor.turns = {turn};
        return faultOf(test::osfFile({sensor}));
    };
    FlatTree turn = sensor.turns[0];
    turn.fields.erase(turn.fields.begin() + 2);
    EXPECT_NE(faultWith(turn).find("another number of columns"), std::string::npos);
    turn = sensorOf(toy, FieldCoding::kPng, 1).turns[0];
    turn.fields[0].tables[1].fields[0].vector[0] = 'x';
    EXPECT_NE(faultWith(turn).find("coded in an unknown way"), std::string::npos);
    turn = sensorOf(toy, FieldCoding::kPng, 1).turns[0];
    turn.fields[1].vector[2] = 7;
    EXPECT_NE(faultWith(turn).find("has no ranges"), std::string::npos);
    FlatTree unmeasured = sensorOf(toy, FieldCoding::kPng, 1).turns[0];
    std::fill(unmeasured.fields[3].vector.begin(), unmeasured.fields[3].vector.end(), '\0');
    EXPECT_NE(faultWith(unmeasured).find("half of their columns: 1"), std::string::npos);
    sensor.json = toy.json().dump();
    EXPECT_NE(faultWith(sensorOf(toy, FieldCoding::kPng, 1).turns[0]).find("pixel_shift_by_row"),
              std::string::npos);
    sensor.json = "{}";
    EXPECT_NE(faultWith(turn).find("its metadata"), std::string::npos);
}

constexpr std::size_t kSamples = 5;

/** Five samples of an IMU, the third of which was not measured; the first number is `first`. */
Bytes imuPacket(float first) {
    Bytes packet(132 + kSamples * 36 + 32);
    for (std::size_t i = 0; i < kSamples; ++i) {
        const std::size_t at = 132 + 36 * i;
        putAt(packet, at, static_cast<std::uint64_t>(1e6 * first) + 10'000'000 * i);
        packet[at + 10] = i == 2 ? 0 : 1;
        for (std::size_t k = 0; k < 6; ++k)
            putAt(packet, at + 12 + 4 * k, first / static_cast<float>(6 * i + k + 1));
    }
    return packet;
}

/** The fields of a turn that hold the same. */
std::vector<FlatTree> imuFields(const Bytes& packet, FieldCoding coding) {
    std::string times, statuses;
    std::vector<std::uint32_t> accelerations(3 * kSamples), rates(3 * kSamples);
    for (std::size_t i = 0; i < kSamples; ++i) {
        const auto* const sample = reinterpret_cast<const char*>(&packet[132 + 36 * i]);
        times.append(sample, 8);
        statuses.append(sample + 10, 2);
        std::memcpy(&accelerations[3 * i], sample + 12, 12);
        std::memcpy(&rates[3 * i], sample + 24, 12);
    }
    const auto field = [](const std::string& name, const std::string& data) {
        return FlatTree().bytes(0, name).bytes(4, data);
    };
    return {field("IMU_ACC", test::codedField(coding, kSamples, 3, 4, accelerations)),
            field("IMU_GYRO", test::codedField(coding, kSamples, 3, 4, rates)),
            field("IMU_STATUS", statuses), field("IMU_TIMESTAMP", times), field("NMEA", "")};
}

TEST_F(Osf, ImuSamplesAreThoseOfThePackets) {
    const OusterToy toy;
    auto json = nlohmann::json::parse(jsonOf(toy));
    json["imu_data_format"] = {{"imu_measurements_per_packet", kSamples}};
    for (const FieldCoding coding : {FieldCoding::kPng, FieldCoding::kZpng}) {
        const auto decoder = io::ousterDecoder(json.dump(), "toy.json");
        auto sensor = sensorOf(toy, coding, 2);
        for (std::uint16_t number = 0; number < 2; ++number) {
            const Bytes imu = imuPacket(100.25F * static_cast<float>(number + 1));
            EXPECT_TRUE(decoder->addImu(imu.data(), imu.size()));
            sensor.turns[number].tables(8, imuFields(imu, coding));
            for (std::size_t i = 0; i < kPackets; ++i) {
                const Bytes packet = packetOf(toy, number, i);
                decoder->add(packet.data(), packet.size(), kNow_s + 0.1 * number);
            }
        }
        decoder->finish();
        const auto expected = decoder->takeImu();
        const auto reader = io::openOsf({write(test::osfFile({sensor})), "", "", ""});
        EXPECT_TRUE(reader->takeImu().empty());
        while (reader->next()) continue;
        EXPECT_EQ(reader->recording().imu, "with the turns");
        const auto read = reader->takeImu();
        ASSERT_EQ(read.size(), 8U);
        ASSERT_EQ(expected.size(), 8U);
        for (std::size_t i = 0; i < 8; ++i) {
            EXPECT_NEAR(read[i].stamp_s, expected[i].stamp_s, 1e-6);
            EXPECT_EQ(read[i].rate_radps, expected[i].rate_radps);
            EXPECT_EQ(read[i].acceleration_mps2, expected[i].acceleration_mps2);
            EXPECT_EQ(read[i].sensorPose.value().matrix(), expected[i].sensorPose.value().matrix());
        }
        EXPECT_TRUE(reader->takeImu().empty());
    }
}

TEST(FieldImage, EveryPixelOfEveryCoding) {
    constexpr std::size_t kRows = 11, kColumns = 37;
    for (const FieldCoding coding : {FieldCoding::kPng, FieldCoding::kZpng})
        for (const std::size_t bytes : {1U, 2U, 3U, 4U}) {
            std::vector<std::uint32_t> pixels;
            std::uint32_t number = 12345;
            for (std::size_t i = 0; i < kRows * kColumns; ++i) {
                number = number * 1664525U + 1013904223U;
                pixels.push_back(bytes == 4 ? number : number & ((1U << 8 * bytes) - 1));
            }
            const std::string coded = test::codedField(coding, kRows, kColumns, bytes, pixels);
            const auto image = io::fieldImageOf(coded, kRows, kColumns);
            EXPECT_EQ(image.pixels, pixels) << bytes;
            EXPECT_EQ(image.isShifted, coding == FieldCoding::kPng);
            EXPECT_THROW(io::fieldImageOf(coded, kRows, kColumns + 1), Error);
            EXPECT_THROW(io::fieldImageOf(coded.substr(0, coded.size() / 2), kRows, kColumns),
                         Error);
        }
}
}  // namespace
