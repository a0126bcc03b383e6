#include "delio/map/cloud_files.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include "delio/core/error.h"
#include "point_support.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::maps::CPointsMapXYZI;
using test::expectEqual;
using test::somePoints;

std::string messageOf(const std::string& path) {
    try {
        map::loadPly(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

void expectSamePlaces(const CPointsMapXYZI& a, const CPointsMapXYZI& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.getPointsBufferRef_x(), b.getPointsBufferRef_x());
    EXPECT_EQ(a.getPointsBufferRef_y(), b.getPointsBufferRef_y());
    EXPECT_EQ(a.getPointsBufferRef_z(), b.getPointsBufferRef_z());
    EXPECT_EQ(a.getPointsBufferRef_intensity(), b.getPointsBufferRef_intensity());
}

TEST(Ply, GivesTheSamePointsBackToUsAndToMrpt) {
    const test::TemporaryFolder folder;
    const auto points = somePoints(10000);
    map::savePly(points, folder / "map.ply");
    expectEqual(map::loadPly(folder / "map.ply"), points);
    CPointsMapXYZI byMrpt;
    testing::internal::CaptureStderr();  // MRPT warns of each colour name that it does not find
    ASSERT_TRUE(byMrpt.loadFromPlyFile(folder / "map.ply"));
    testing::internal::GetCapturedStderr();
    expectSamePlaces(byMrpt, map::cloudOf(points));
}

TEST(Ply, HasTheColoursThatAreAskedFor) {
    const test::TemporaryFolder folder;
    auto points = somePoints(1);
    points[0].normal = {1, 0, -1};
    map::savePly(points, folder / "map.ply", {map::ColourBy::Normal});
    const std::string bytes = test::readText(folder / "map.ply");
    EXPECT_EQ(bytes.substr(bytes.size() - 3), std::string("\xff\x80\x00", 3));
    points[0].residual_m = 0;
    EXPECT_THROW(map::savePly(points, folder / "no.ply", {map::ColourBy::Residual}), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "no.ply"));
}

TEST(Ply, ReadsWhatMrptWrites) {
    const test::TemporaryFolder folder;
    const auto cloud = map::cloudOf(somePoints());
    ASSERT_TRUE(cloud.saveToPlyFile(folder / "binary.ply", true));
    const auto binary = map::cloudOf(map::loadPly(folder / "binary.ply"));
    ASSERT_EQ(binary.size(), cloud.size());
    EXPECT_EQ(binary.getPointsBufferRef_x(), cloud.getPointsBufferRef_x());
    EXPECT_NEAR(binary.getPointIntensity_fast(7), cloud.getPointIntensity_fast(7), 1e-6);
    ASSERT_TRUE(cloud.saveToPlyFile(folder / "ascii.ply", false));
    const auto ascii = map::cloudOf(map::loadPly(folder / "ascii.ply"));
    ASSERT_EQ(ascii.size(), cloud.size());
    EXPECT_NEAR(ascii.getPointsBufferRef_x()[7], cloud.getPointsBufferRef_x()[7], 0.01);
}

TEST(Ply, ReadsFilesWithPlacesIntensityAndColoursOnly) {
    const test::TemporaryFolder folder;
    std::string text =
        "ply\nformat binary_little_endian 1.0\ncomment DeLiO map, metres\nelement vertex 2\n"
        "property float x\nproperty float y\nproperty float z\nproperty float intensity\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    for (const float first : {1.0F, 5.0F}) {
        const float numbers[4] = {first, first + 1, first + 2, first + 3};
        text.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
        text.append("rgb");
    }
    test::writeText(folder / "old.ply", text);
    auto expected = map::MapPoints{test::pointAt(1, 2, 3), test::pointAt(5, 6, 7)};
    expected[0].intensity = 4;
    expected[1].intensity = 8;
    expectEqual(map::loadPly(folder / "old.ply"), expected);
}

TEST(Ply, SkipsOtherPropertiesAndPointsThatAreNotFinite) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.ply",
                    "ply\r\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty uchar red\n"
                    "property double z\nproperty float y\nproperty float x\nelement face 0\n"
                    "property list uchar int vertex_indices\nend_header\n"
                    "255 3 2 1\n255 nan 2 1\n0 6 5 4\n");
    expectEqual(map::loadPly(folder / "a.ply"), {test::pointAt(1, 2, 3), test::pointAt(4, 5, 6)});
}

TEST(Ply, ReadsColumnsByNameInAnyOrder) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.ply",
                    "ply\nformat ascii 1.0\nelement vertex 2\nproperty int observations\n"
                    "property float nz\nproperty double time\nproperty float x\nproperty float y\n"
                    "property float z\nproperty float residual\nproperty float normal_x\n"
                    "end_header\n12 1 2.5 1 2 3 0.25 0.5\n99999 nan inf 1 2 3 nan 0\n");
    auto first = test::pointAt(1, 2, 3), second = first;
    first.observations = 12;
    first.normal = {0.5F, 0, 1};
    first.time_s = 2.5F;
    first.residual_m = 0.25F;
    second.observations = 65535;  // what is not known is 0
    expectEqual(map::loadPly(folder / "a.ply"), {first, second});
}

TEST(Ply, BadFilesAreErrorsThatNameTheFile) {
    const test::TemporaryFolder folder;
    map::savePly(somePoints(), folder / "whole.ply");
    const std::string whole = test::readText(folder / "whole.ply");
    for (const std::size_t length : {0UL, 3UL, 50UL, 200UL, 1000UL, whole.size() - 1}) {
        test::writeText(folder / "cut.ply", whole.substr(0, length));
        EXPECT_NE(messageOf(folder / "cut.ply").find("cut.ply"), std::string::npos) << length;
    }
    const std::string head = "ply\nformat ascii 1.0\nelement vertex ";
    const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const std::string& text :
         {std::string("hello\n"), head + "-1" + xyz, head + "many" + xyz,
          head + "1\nproperty float x\nproperty float y\nend_header\n1 2\n",
          head + "1\nproperty list uchar int x\nend_header\n", head + "1" + xyz + "1 2\n",
          head + "99999999999999" + xyz + "1 2 3\n", head + "1" + xyz + "1 2 abc\n",
          std::string("ply\nformat binary_big_endian 1.0\nelement vertex 1") + xyz}) {
        test::writeText(folder / "bad.ply", text);
        EXPECT_NE(messageOf(folder / "bad.ply").find("bad.ply"), std::string::npos) << text;
    }
    EXPECT_NE(messageOf(folder / "missing.ply"), "");
    EXPECT_NE(messageOf(folder.path().string()), "");
    EXPECT_THROW(map::savePly(somePoints(), folder / "no/such/folder.ply"), Error);
}
}  // namespace
