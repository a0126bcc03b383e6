#include "delio/map/ply.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <random>

#include "delio/core/error.h"
#include "test_data.h"

namespace {
using namespace delio;
using mrpt::maps::CPointsMapXYZI;

CPointsMapXYZI someCloud() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place(-4000, 4000), intensity(0, 1);
    CPointsMapXYZI cloud;
    for (int i = 0; i < 1000; ++i) {
        const float x = place(random), y = place(random), z = place(random);
        cloud.insertPointRGB(x, y, z, intensity(random), 0, 0);
    }
    return cloud;
}

void expectEqual(const CPointsMapXYZI& a, const CPointsMapXYZI& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.getPointsBufferRef_x(), b.getPointsBufferRef_x());
    EXPECT_EQ(a.getPointsBufferRef_y(), b.getPointsBufferRef_y());
    EXPECT_EQ(a.getPointsBufferRef_z(), b.getPointsBufferRef_z());
    EXPECT_EQ(a.getPointsBufferRef_intensity(), b.getPointsBufferRef_intensity());
}

std::string messageOf(const std::string& path) {
    try {
        map::loadPly(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Ply, GivesTheSameFloatsBackToUsAndToMrpt) {
    const test::TemporaryFolder folder;
    const auto cloud = someCloud();
    map::savePly(cloud, folder / "map.ply");
    expectEqual(map::loadPly(folder / "map.ply"), cloud);
    CPointsMapXYZI byMrpt;
    testing::internal::CaptureStderr();  // MRPT warns of each colour name that it does not find
    ASSERT_TRUE(byMrpt.loadFromPlyFile(folder / "map.ply"));
    testing::internal::GetCapturedStderr();
    expectEqual(byMrpt, cloud);
}

TEST(Ply, ReadsWhatMrptWrites) {
    const test::TemporaryFolder folder;
    const auto cloud = someCloud();
    ASSERT_TRUE(cloud.saveToPlyFile(folder / "binary.ply", true));
    const auto binary = map::loadPly(folder / "binary.ply");
    ASSERT_EQ(binary.size(), cloud.size());
    EXPECT_EQ(binary.getPointsBufferRef_x(), cloud.getPointsBufferRef_x());
    EXPECT_NEAR(binary.getPointIntensity_fast(7), cloud.getPointIntensity_fast(7), 1e-6);
    ASSERT_TRUE(cloud.saveToPlyFile(folder / "ascii.ply", false));
    const auto ascii = map::loadPly(folder / "ascii.ply");
    ASSERT_EQ(ascii.size(), cloud.size());
    EXPECT_NEAR(ascii.getPointsBufferRef_x()[7], cloud.getPointsBufferRef_x()[7], 0.01);
}

TEST(Ply, SkipsOtherPropertiesAndPointsThatAreNotFinite) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.ply",
                    "ply\r\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty uchar red\n"
                    "property double z\nproperty float y\nproperty float x\nelement face 0\n"
                    "property list uchar int vertex_indices\nend_header\n"
                    "255 3 2 1\n255 nan 2 1\n0 6 5 4\n");
    const auto cloud = map::loadPly(folder / "a.ply");
    ASSERT_EQ(cloud.size(), 2U);
    EXPECT_EQ(cloud.getPointsBufferRef_x()[1], 4);
    EXPECT_EQ(cloud.getPointsBufferRef_y()[1], 5);
    EXPECT_EQ(cloud.getPointsBufferRef_z()[1], 6);
}

TEST(Ply, BadFilesAreErrorsThatNameTheFile) {
    const test::TemporaryFolder folder;
    map::savePly(someCloud(), folder / "whole.ply");
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
    EXPECT_THROW(map::savePly(someCloud(), folder / "no/such/folder.ply"), Error);
}
}  // namespace
