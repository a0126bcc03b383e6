#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "delio/core/error.h"
#include "ouster_packets.h"
#include "recordings/ouster.h"
#include "recordings/packet_decoder.h"

namespace {
using namespace delio;
using test::Bytes;
using test::OusterToy;
using test::putAt;
constexpr double kNow_s = 1600000000;

std::unique_ptr<io::PacketDecoder> decoderOf(const OusterToy& toy) {
    return io::ousterDecoder(toy.json().dump(), "toy.json");
}

std::vector<Scan> finish(io::PacketDecoder& decoder) {
    decoder.finish();
    std::vector<Scan> scans;
    while (auto scan = decoder.take()) scans.push_back(*scan);
    return scans;
}

void addTurn(io::PacketDecoder& decoder, const OusterToy& toy, std::uint16_t frame,
             std::size_t packets = 32) {
    for (std::size_t i = 0; i < packets; ++i) {
        const Bytes packet = toy.packet(frame, i);
        decoder.add(packet.data(), packet.size(), kNow_s + 0.1 * frame);
    }
}

/** Ouster's sensor manual, "Lidar range to XYZ", with n = 20 mm and the sensor turned by 180 deg
 *  and 36 mm up. */
Eigen::Vector3d expected(std::size_t row, std::size_t column, double range) {
    const double turned = 2 * M_PI * (1 - static_cast<double>(column) / 512);
    const double angle = turned - (row % 2 ? 3 : -3) * M_PI / 180;
    const double up = (15 - 2 * static_cast<double>(row)) * M_PI / 180;
    const double flat = (range - 0.02) * std::cos(up);
    return {-(flat * std::cos(angle) + 0.02 * std::cos(turned)),
            -(flat * std::sin(angle) + 0.02 * std::sin(turned)),
            (range - 0.02) * std::sin(up) + 0.036};
}

TEST(PacketsOuster, PointsOfEveryProfile) {
    for (const char* const profile :
         {"LEGACY", "RNG15_RFL8_NIR8", "RNG15_RFL8_WIN8", "RNG15_RFL8_NIR8_DUAL",
          "FUSA_RNG15_RFL8_NIR8_DUAL", "RNG15_RFL8_NIR8_ZONE16", "RNG19_RFL8_SIG16_NIR16",
          "RNG19_RFL8_SIG16_NIR16_ZONE16", "RNG19_RFL8_SIG16_NIR16_DUAL",
          "RNG19_RFL8_SIG16_ZONE16_DUAL", "RNG19_RFL8_SIG16_NIR16_RGB16",
          "RNG19_RFL8_SIG16_NIR16_RGB16_DUAL", "FIVE_WORD_PIXEL"}) {
        const OusterToy toy{profile};
        const auto decoder = decoderOf(toy);
        addTurn(*decoder, toy, 65535);
        addTurn(*decoder, toy, 0);
        const auto scans = finish(*decoder);
        ASSERT_EQ(scans.size(), 2U) << profile;
        EXPECT_EQ(decoder->sensor(), "Ouster OS-1-16");
        const auto* cloud = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(scans[1].points.get());
        ASSERT_TRUE(cloud);
        ASSERT_EQ(cloud->size(), 16U * 512);
        for (std::size_t i = 0; i < cloud->size(); ++i) {
            float x = 0, y = 0, z = 0;
            cloud->getPoint(i, x, y, z);
            const Eigen::Vector3d point(x, y, z);
            ASSERT_LT((point - expected(i % 16, i / 16, 5)).norm(), 2e-6) << profile << " " << i;
            ASSERT_EQ(scans[1].rings[i], i % 16);
            ASSERT_FLOAT_EQ(cloud->getPointIntensity(i), 0.2F);
            ASSERT_NEAR(scans[1].times_s[i], static_cast<double>(i / 16) * 195312e-9, 1e-7);
        }
    }
}

TEST(PacketsOuster, StampsOfItsOwnClockAndOfUnixTime) {
    OusterToy toy;
    auto decoder = decoderOf(toy);
    addTurn(*decoder, toy, 1);
    addTurn(*decoder, toy, 2);
    auto scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 2U);
    EXPECT_NEAR(scans[0].stamp_s, kNow_s + 0.1, 1e-6);  // when it was recorded
    EXPECT_NEAR(scans[1].stamp_s - scans[0].stamp_s, 512 * 195312e-9, 1e-6);

    toy.start_ns = 1700000000ULL * 1000000000ULL;
    decoder = decoderOf(toy);
    addTurn(*decoder, toy, 0);
    scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 1U);
    EXPECT_NEAR(scans[0].stamp_s, 1700000000, 1e-6);
}

TEST(PacketsOuster, BadColumnsLatePacketsAndHalfTurns) {
    const OusterToy toy;
    const auto decoder = decoderOf(toy);
    addTurn(*decoder, toy, 4, 15);  // less than half a turn
    addTurn(*decoder, toy, 5, 31);
    Bytes packet = toy.packet(6, 0);
    packet[32 + 10] = 0;  // the status of its first column
    decoder->add(packet.data(), packet.size(), kNow_s);
    packet = toy.packet(5, 31);
    decoder->add(packet.data(), packet.size(), kNow_s);
    packet = toy.packet(6, 1);
    putAt(packet, 32 + 12, 0U);  // no return
    decoder->add(packet.data(), packet.size(), kNow_s);
    addTurn(*decoder, toy, 7, 16);
    addTurn(*decoder, toy, 8, 15);
    const auto scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 3U);
    EXPECT_EQ(scans[0].points->size(), 31U * 256);
    EXPECT_EQ(scans[1].points->size(), 31U * 16 - 1);
    EXPECT_EQ(scans[2].points->size(), 16U * 256);
}

/** The scan of one turn whose packets come in this order. */
Scan scanOf(const OusterToy& toy, const std::vector<std::size_t>& order) {
    const auto decoder = decoderOf(toy);
    for (const std::size_t i : order) {
        const Bytes packet = toy.packet(1, i);
        decoder->add(packet.data(), packet.size(), kNow_s);
    }
    const auto scans = finish(*decoder);
    return scans.empty() ? Scan() : scans.front();
}

TEST(PacketsOuster, PacketsOfATurnMayComeLateOrAgain) {
    const OusterToy toy;
    std::vector<std::size_t> inOrder(32);
    std::iota(inOrder.begin(), inOrder.end(), 0);
    auto late = inOrder, again = inOrder, backwards = inOrder;
    std::swap(late[7], late[9]);
    again.insert(again.begin() + 20, 3);
    std::reverse(backwards.begin(), backwards.end());
    const Scan expected = scanOf(toy, inOrder);
    ASSERT_EQ(expected.points->size(), 16U * 512);
    for (const auto& order : {late, again, backwards}) {
        const Scan scan = scanOf(toy, order);
        ASSERT_EQ(scan.points->size(), expected.points->size());
        EXPECT_EQ(scan.points->getPointsBufferRef_x(), expected.points->getPointsBufferRef_x());
        EXPECT_EQ(scan.points->getPointsBufferRef_y(), expected.points->getPointsBufferRef_y());
        EXPECT_EQ(scan.points->getPointsBufferRef_z(), expected.points->getPointsBufferRef_z());
        EXPECT_EQ(scan.rings, expected.rings);
        EXPECT_EQ(scan.times_s, expected.times_s);
    }
}

TEST(PacketsOuster, AWholeTurnIsAScanWithItsLastPacket) {
    const OusterToy toy;
    const auto decoder = decoderOf(toy);
    addTurn(*decoder, toy, 5, 31);
    EXPECT_FALSE(decoder->take());
    const Bytes last = toy.packet(5, 31);
    decoder->add(last.data(), last.size(), kNow_s);
    const auto whole = decoder->take();
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->points->size(), 32U * 256);
    EXPECT_TRUE(decoder->endedWhole());
    // A packet that comes twice begins no scan.
    decoder->add(last.data(), last.size(), kNow_s);
    addTurn(*decoder, toy, 6, 30);
    EXPECT_FALSE(decoder->take());
    addTurn(*decoder, toy, 7, 1);
    const auto part = decoder->take();
    ASSERT_TRUE(part);
    EXPECT_EQ(part->points->size(), 30U * 256);
    EXPECT_FALSE(decoder->endedWhole());
    EXPECT_TRUE(finish(*decoder).empty());
}

std::string faultOf(io::PacketDecoder& decoder) {
    try {
        decoder.finish();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(PacketsOuster, LessThanHalfATurnSaysSo) {
    const OusterToy toy;
    const auto none = decoderOf(toy), little = decoderOf(toy), half = decoderOf(toy);
    EXPECT_EQ(faultOf(*none), "");
    addTurn(*little, toy, 4, 2);
    EXPECT_NE(faultOf(*little).find("only 2 of the 32 packets of a revolution"), std::string::npos);
    addTurn(*half, toy, 4, 16);
    EXPECT_EQ(faultOf(*half), "");
    const auto unmeasured = decoderOf(toy);
    Bytes packet = toy.packet(0, 0);
    for (std::size_t c = 0; c < 16; ++c) packet[32 + 204 * c + 10] = 0;
    for (int i = 0; i < 32; ++i) unmeasured->add(packet.data(), packet.size(), kNow_s);
    EXPECT_NE(faultOf(*unmeasured).find("marked as invalid"), std::string::npos);
}

TEST(PacketsOuster, HeaderOfFunctionalSafety) {
    OusterToy toy{"FUSA_RNG15_RFL8_NIR8_DUAL"};
    toy.serial = 992137000142;
    toy.initialization = 9599938;
    auto json = toy.json();
    const io::OusterInfo info = io::readOusterInfo(json.dump(), "toy.json");
    const Bytes bytes = toy.packet(300, 2);
    ASSERT_EQ(info.packetBytes(), bytes.size());
    const io::OusterPacket packet(info, bytes.data());
    EXPECT_EQ(packet.ids().serial, toy.serial);
    EXPECT_EQ(packet.ids().initialization, toy.initialization);
    EXPECT_EQ(packet.frameOf(0), 300);
    EXPECT_EQ(packet.place(3), 35U);
    // Firmware 3.2 names the header apart from the profile.
    json["data_format"]["udp_profile_lidar"] = "RNG15_RFL8_NIR8_DUAL";
    EXPECT_FALSE(io::readOusterInfo(json.dump(), "toy.json").layout.safety);
    json["data_format"]["header_type"] = "FUSA";
    EXPECT_TRUE(io::readOusterInfo(json.dump(), "toy.json").layout.safety);
}

/** Whether packets of `sent` go with the json of `described`. */
bool fits(const OusterToy& sent, const OusterToy& described) {
    const auto decoder = decoderOf(described);
    addTurn(*decoder, sent, 0);
    const std::string fault = faultOf(*decoder);
    const bool fits = decoder->take().has_value();
    EXPECT_EQ(fits, fault.empty());
    return fits;
}

TEST(PacketsOuster, SerialNumbersAndStartsHaveToBeTheSame) {
    OusterToy one, other, restarted, unknown, legacy{"LEGACY"};
    one.serial = other.serial = restarted.serial = legacy.serial = 992137000142;
    one.initialization = other.initialization = 9599938;
    other.serial = 122201000998;
    restarted.initialization = 9599939;
    EXPECT_TRUE(fits(one, one));
    EXPECT_FALSE(fits(one, other));
    EXPECT_FALSE(fits(one, restarted));
    // What one of them does not know is not compared.
    EXPECT_TRUE(fits(one, unknown));
    EXPECT_TRUE(fits(unknown, one));
    restarted.serial = 0;
    restarted.initialization = one.initialization;
    EXPECT_TRUE(fits(one, restarted));
    legacy.initialization = 7;
    EXPECT_TRUE(fits(legacy, legacy));
    OusterToy otherLegacy = legacy;
    otherLegacy.serial = 5;
    EXPECT_TRUE(fits(legacy, otherLegacy));  // its packets have neither
}

TEST(PacketsOuster, AnotherSensorsDescriptionNamesBoth) {
    OusterToy sent, described;
    sent.serial = 992137000142;
    sent.initialization = 9599938;
    described.serial = 122201000998;
    described.initialization = 7109750;
    auto decoder = decoderOf(described);
    addTurn(*decoder, sent, 0);
    std::string fault = faultOf(*decoder);
    for (const char* const part :
         {"serial number 992137000142", "9599938", "serial number 122201000998", "7109750",
          "'toy.json'", "--sensor-info"})
        EXPECT_NE(fault.find(part), std::string::npos) << fault;
    EXPECT_EQ(fault.find("restarted"), std::string::npos) << fault;
    described.serial = sent.serial;
    decoder = decoderOf(described);
    addTurn(*decoder, sent, 0);
    fault = faultOf(*decoder);
    EXPECT_NE(fault.find("remove initialization_id from it"), std::string::npos) << fault;
    // It does not take the whole recording to see that.
    EXPECT_THROW(for (std::uint16_t turn = 1; turn < 40; ++turn) addTurn(*decoder, sent, turn),
                 Error);
}

TEST(PacketsOuster, PacketsOfAnotherSensorAreLeftOut) {
    OusterToy toy, other;
    toy.serial = 5;
    other.serial = 6;
    other.range_mm = 9000;
    const auto decoder = decoderOf(toy);
    addTurn(*decoder, other, 0, 3);
    addTurn(*decoder, toy, 0);
    addTurn(*decoder, other, 1, 3);
    addTurn(*decoder, toy, 1);
    const auto scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 2U);
    for (const Scan& scan : scans) EXPECT_EQ(scan.points->size(), 16U * 512);
    ASSERT_EQ(decoder->findings().size(), 1U);
    EXPECT_EQ(decoder->findings()[0].find("ignored 6 packets (first in scan 0) of the Ouster "
                                          "with serial number 6"),
              0U);
}

TEST(PacketsOuster, ASensorThatIsStartedAgainIsTheSame) {
    OusterToy toy;
    toy.serial = 5;
    toy.initialization = 100;
    const auto decoder = decoderOf(toy);
    for (std::uint16_t turn = 100; turn < 103; ++turn) addTurn(*decoder, toy, turn);
    toy.initialization = 101;  // its clock and its turns count from zero again
    for (std::uint16_t turn = 0; turn < 3; ++turn) addTurn(*decoder, toy, turn);
    EXPECT_EQ(finish(*decoder).size(), 6U);
    EXPECT_TRUE(decoder->findings().empty());
}

/** A turn of which some columns have other times. */
void addTurn(io::PacketDecoder& decoder, const OusterToy& toy, std::uint16_t frame,
             const std::function<std::optional<std::uint64_t>(std::size_t)>& otherTime) {
    for (std::size_t i = 0; i < 32; ++i) {
        Bytes packet = toy.packet(frame, i);
        for (std::size_t c = 0; c < 16; ++c)
            if (const auto time_ns = otherTime(16 * i + c)) putAt(packet, 32 + 204 * c, *time_ns);
        decoder.add(packet.data(), packet.size(), kNow_s + 0.1 * frame);
    }
}

void expectTimesOfAWholeTurn(const Scan& scan, std::uint16_t frame) {
    EXPECT_NEAR(scan.stamp_s, kNow_s + frame * 512 * 195312e-9, 1e-6);
    ASSERT_EQ(scan.times_s.size(), 16U * 512);
    for (std::size_t i = 0; i < scan.times_s.size(); ++i) {
        const std::size_t column = i / 16;
        ASSERT_NEAR(scan.times_s[i], static_cast<double>(column) * 195312e-9, 1e-6) << i;
    }
}

TEST(PacketsOuster, WrongTimesOfColumnsAreInterpolated) {
    const OusterToy toy;
    std::mt19937_64 random(3);
    const auto decoder = decoderOf(toy);
    addTurn(*decoder, toy, 0);
    addTurn(*decoder, toy, 1, [](std::size_t column) {
        return column == 100 ? std::optional<std::uint64_t>(0) : std::nullopt;
    });
    addTurn(*decoder, toy, 2, [&](std::size_t column) {  // the first and the last one, too
        return column % 10 == 0 || column == 511 ? std::optional<std::uint64_t>(random())
                                                 : std::nullopt;
    });
    const auto scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 3U);
    for (std::uint16_t frame = 0; frame < 3; ++frame) expectTimesOfAWholeTurn(scans[frame], frame);
    ASSERT_EQ(decoder->findings().size(), 1U);
    EXPECT_NE(decoder->findings()[0].find("54 columns (first in scan 1)"), std::string::npos)
        << decoder->findings()[0];
}

TEST(PacketsOuster, ATurnWhoseTimesMakeNoSenseHasNone) {
    const OusterToy toy;
    std::mt19937_64 random(3);
    const auto decoder = decoderOf(toy);
    addTurn(*decoder, toy, 0);
    addTurn(*decoder, toy, 1, [&](std::size_t) { return random(); });
    addTurn(*decoder, toy, 2, [](std::size_t) { return 0; });
    addTurn(*decoder, toy, 3);
    const auto scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 4U);
    for (const std::size_t turn : {1U, 2U}) {
        EXPECT_TRUE(scans[turn].times_s.empty());
        EXPECT_NEAR(scans[turn].stamp_s, kNow_s + 0.1 * static_cast<double>(turn), 1e-3);
        EXPECT_EQ(scans[turn].points->size(), 16U * 512);
    }
    expectTimesOfAWholeTurn(scans[3], 3);
    ASSERT_EQ(decoder->findings().size(), 1U);
    EXPECT_NE(decoder->findings()[0].find("2 turns (first in scan 1)"), std::string::npos);
}

TEST(PacketsOuster, TheNestedDescriptionSaysTheSame) {
    const OusterToy toy;
    auto flat = toy.json();
    nlohmann::json nested{
        {"beam_intrinsics",
         {{"beam_altitude_angles", flat["beam_altitude_angles"]},
          {"beam_azimuth_angles", flat["beam_azimuth_angles"]},
          {"beam_to_lidar_transform", {1, 0, 0, 20, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}}},
        {"lidar_data_format", flat["data_format"]},
        {"lidar_intrinsics", {{"lidar_to_sensor_transform", flat["lidar_to_sensor_transform"]}}},
        {"sensor_info", {{"prod_line", "OS-1-16"}}},
        {"config_params", {{"lidar_mode", "512x10"}}}};
    const auto decoder = io::ousterDecoder(nested.dump(), "nested.json");
    addTurn(*decoder, toy, 0);
    const auto scans = finish(*decoder);
    ASSERT_EQ(scans.size(), 1U);
    float x = 0, y = 0, z = 0;
    scans[0].points->getPoint(1000, x, y, z);
    EXPECT_LT((Eigen::Vector3d(x, y, z) - expected(1000 % 16, 1000 / 16, 5)).norm(), 2e-6);
    EXPECT_EQ(decoder->sensor(), "Ouster OS-1-16");
}

std::string faultOf(const std::string& json) {
    try {
        io::ousterDecoder(json, "toy.json");
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(PacketsOuster, WrongDescriptionsNameTheKey) {
    EXPECT_EQ(faultOf(OusterToy().json().dump()), "");
    for (const char* const text : {"", "{", "[]", "3"})
        EXPECT_NE(faultOf(text).find("toy.json"), std::string::npos) << text;
    for (const char* const key : {"beam_altitude_angles", "beam_azimuth_angles"}) {
        auto json = OusterToy().json();
        json.erase(key);
        EXPECT_NE(faultOf(json.dump()).find(key), std::string::npos);
        json[key] = "up";
        EXPECT_NE(faultOf(json.dump()).find(key), std::string::npos);
        json[key] = {1, 2};
        EXPECT_NE(faultOf(json.dump()).find(key), std::string::npos);
    }
    auto json = OusterToy().json();
    for (const char* const key : {"beam_altitude_angles", "beam_azimuth_angles"})
        json[key] = std::vector<double>(100000);
    json["data_format"].erase("pixels_per_column");
    EXPECT_NE(faultOf(json.dump()).find("beam_altitude_angles is too long"), std::string::npos);
    json = OusterToy().json();
    json["data_format"]["udp_profile_lidar"] = "RNG99";
    EXPECT_NE(faultOf(json.dump()).find("RNG99"), std::string::npos);
    for (const char* const key :
         {"columns_per_frame", "columns_per_packet", "column_window", "pixel_shift_by_row"})
        for (const double number : {1.5e36, -1.5e36}) {
            json = OusterToy().json();
            if (std::string(key).find("per_") != std::string::npos)
                json["data_format"][key] = number;
            else
                json["data_format"][key] = std::vector<double>(16, number);
            EXPECT_NE(faultOf(json.dump()).find(std::string(key) + " is out of range"),
                      std::string::npos)
                << faultOf(json.dump());
        }
    json = OusterToy().json();
    json["lidar_to_sensor_transform"] = {1, 2};
    EXPECT_NE(faultOf(json.dump()).find("lidar_to_sensor_transform"), std::string::npos);
    json.erase("data_format");
    json.erase("lidar_mode");
    json.erase("lidar_to_sensor_transform");
    EXPECT_NE(faultOf(json.dump()).find("lidar_mode"), std::string::npos);
}
/** 1 g upwards and 90 deg/s about z. */
Bytes imuPacket(std::uint64_t time_ns) {
    Bytes packet(48);
    putAt<std::uint64_t>(packet, 16, time_ns);
    putAt<float>(packet, 32, 1);
    putAt<float>(packet, 44, 90);
    return packet;
}

TEST(PacketsOuster, SamplesOfItsImuHaveTheClockOfTheScans) {
    const OusterToy toy;
    const auto decoder = decoderOf(toy);
    addTurn(*decoder, toy, 1, 31);
    const Bytes early = imuPacket(0);
    EXPECT_TRUE(decoder->addImu(early.data(), early.size()));
    EXPECT_TRUE(decoder->takeImu().empty());  // no scan shows the clock yet
    addTurn(*decoder, toy, 2);
    const auto scans = finish(*decoder);
    const auto first = decoder->takeImu();
    ASSERT_EQ(first.size(), 1U);
    const Bytes late = imuPacket(50'000'000);
    EXPECT_TRUE(decoder->addImu(late.data(), late.size()));
    EXPECT_FALSE(decoder->addImu(late.data(), 47));
    const auto second = decoder->takeImu();
    ASSERT_EQ(second.size(), 1U);
    EXPECT_NEAR(second[0].stamp_s - first[0].stamp_s, 0.05, 1e-6);
    EXPECT_LT(std::abs(first[0].stamp_s - scans[0].stamp_s), 10);
    EXPECT_TRUE(second[0].acceleration_mps2.isApprox(Eigen::Vector3d(0, 0, 9.80665), 1e-6));
    EXPECT_TRUE(second[0].rate_radps.isApprox(Eigen::Vector3d(0, 0, M_PI / 2), 1e-6));
    ASSERT_TRUE(second[0].sensorPose);
    EXPECT_TRUE(second[0].sensorPose->translation().isApprox(
        Eigen::Vector3d(6.253e-3, -11.775e-3, 7.645e-3)));
}

TEST(PacketsOuster, SeveralSamplesOfItsImuInAPacket) {
    constexpr std::size_t kSamples = 8, kFirst = 132, kEach = 36;
    const OusterToy toy;
    auto json = toy.json();
    json["imu_data_format"] = {{"imu_measurements_per_packet", kSamples}};
    json["imu_intrinsics"] = {
        {"imu_to_sensor_transform", {1, 0, 0, 4, 0, 1, 0, 5, 0, 0, 1, 6, 0, 0, 0, 1}}};
    const auto decoder = io::ousterDecoder(json.dump(), "toy.json");
    Bytes packet(kFirst + kSamples * kEach + 32);
    for (std::size_t i = 0; i < kSamples; ++i) {
        const std::size_t at = kFirst + i * kEach;
        putAt<std::uint64_t>(packet, at, 10'000'000 * i);
        putAt<std::uint16_t>(packet, at + 10, i == 3 ? 0 : 1);  // the fourth was not measured
        putAt<float>(packet, at + 16, static_cast<float>(i));
        putAt<float>(packet, at + 32, 0.5F);
    }
    EXPECT_FALSE(decoder->addImu(packet.data(), packet.size() - kEach));
    EXPECT_TRUE(decoder->addImu(packet.data(), packet.size()));
    addTurn(*decoder, toy, 1);
    finish(*decoder);
    const auto samples = decoder->takeImu();
    ASSERT_EQ(samples.size(), 7U);
    for (std::size_t k = 0; k < 7; ++k) {
        const auto i = static_cast<double>(k < 3 ? k : k + 1);
        EXPECT_NEAR(samples[k].stamp_s - samples[0].stamp_s, 0.01 * i, 1e-6);
        EXPECT_EQ(samples[k].acceleration_mps2, Eigen::Vector3d(0, i, 0));
        EXPECT_EQ(samples[k].rate_radps, Eigen::Vector3d(0, 0, 0.5));
        EXPECT_TRUE(samples[k].sensorPose.value().translation().isApprox(
            Eigen::Vector3d(0.004, 0.005, 0.006)));
    }
}
}  // namespace
