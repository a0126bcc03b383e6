#include "delio/map/cloud_files.h"

#include <gtest/gtest.h>

#include <cstring>

#include "delio/core/error.h"
#include "point_support.h"
#include "test_data.h"

namespace {
using namespace delio;
using test::expectEqual;
using test::pointAt;
using test::somePoints;

const std::string kXyz =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";

std::string messageOf(const std::string& path) {
    try {
        map::loadPcd(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Pcd, GivesTheSamePointsBack) {
    const test::TemporaryFolder folder;
    for (const std::size_t count : {0, 1, 4096, 10000}) {
        const auto points = somePoints(count);
        map::savePcd(points, folder / "map.pcd");
        expectEqual(map::loadPcd(folder / "map.pcd"), points);
    }
}

TEST(Pcd, IsWhatThePointCloudLibraryReads) {
    const test::TemporaryFolder folder;
    auto points = somePoints(2);
    points[1].normal = {1, 0, -1};
    map::savePcd(points, folder / "map.pcd", {map::ColourBy::Normal});
    const std::string text = test::readText(folder / "map.pcd");
    const std::string header =
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
        "FIELDS x y z normal_x normal_y normal_z intensity time residual observations rgb\n"
        "SIZE 4 4 4 4 4 4 4 4 4 2 4\nTYPE F F F F F F F F F U F\nCOUNT 1 1 1 1 1 1 1 1 1 1 1\n"
        "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA binary\n";
    ASSERT_EQ(text.substr(0, header.size()), header);
    ASSERT_EQ(text.size(), header.size() + std::size_t{2} * 42);
    float x = 0;
    std::memcpy(&x, text.data() + header.size() + 42, sizeof(x));
    EXPECT_EQ(x, points[1].position.x());
    std::uint32_t rgb = 0;
    std::memcpy(&rgb, text.data() + text.size() - 4, sizeof(rgb));
    EXPECT_EQ(rgb, 0xff8000U);
}

TEST(Pcd, ReadsAsciiWithWhateverFieldsThereAre) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.pcd",
                    "VERSION .7\nFIELDS intensity x y z _ rgb fpfh\nSIZE 1 8 8 8 1 4 4\n"
                    "TYPE U F F F U F F\nCOUNT 1 1 1 1 3 1 2\nWIDTH 3\nHEIGHT 1\n"
                    "VIEWPOINT 5 5 5 1 0 0 0\nPOINTS 3\nDATA ascii\n"
                    "7 1 2 3 0 0 0 4.2e+06 1 2\r\n7 nan 2 3 0 0 0 0 1 2\n8 4 5 6 0 0 0 nan 1 2\n");
    auto first = pointAt(1, 2, 3), second = pointAt(4, 5, 6);
    first.intensity = 7;
    second.intensity = 8;
    expectEqual(map::loadPcd(folder / "a.pcd"), {first, second});
}

TEST(Pcd, ReadsBinaryOfOtherTypesAndOrganisedClouds) {
    const test::TemporaryFolder folder;
    std::string text =
        "VERSION 0.7\nFIELDS _ z y x\nSIZE 2 8 4 1\nTYPE U F I I\nCOUNT 2 1 1 1\nWIDTH 2\n"
        "HEIGHT 2\nDATA binary\n";
    for (int i = 0; i < 4; ++i) {
        const double z = 0.5 * i;
        const std::int32_t y = -1000 * i;
        text.append(4, 'p');
        text.append(reinterpret_cast<const char*>(&z), sizeof(z));
        text.append(reinterpret_cast<const char*>(&y), sizeof(y));
        text += static_cast<char>(-i);
    }
    test::writeText(folder / "b.pcd", text);
    const auto points = map::loadPcd(folder / "b.pcd");
    ASSERT_EQ(points.size(), 4U);
    EXPECT_EQ(points[3].position, Eigen::Vector3f(-3, -3000, 1.5F));
}

TEST(Pcd, CompressedIsAnErrorThatSaysSo) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "c.pcd",
                    kXyz + "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary_compressed\nxyz");
    const std::string message = messageOf(folder / "c.pcd");
    EXPECT_NE(message.find("c.pcd"), std::string::npos) << message;
    EXPECT_NE(message.find("compressed"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(Pcd, BadFilesAreErrorsThatNameTheFile) {
    const test::TemporaryFolder folder;
    map::savePcd(somePoints(), folder / "whole.pcd");
    const std::string whole = test::readText(folder / "whole.pcd");
    for (const std::size_t length : {0UL, 3UL, 100UL, 250UL, 1000UL, whole.size() - 1}) {
        test::writeText(folder / "cut.pcd", whole.substr(0, length));
        EXPECT_NE(messageOf(folder / "cut.pcd").find("cut.pcd"), std::string::npos) << length;
    }
    const std::string size = "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n";
    const std::string fields = "VERSION 0.7\nFIELDS ";
    for (const std::string& text :
         {std::string("hello\n"), kXyz + size + "1 2\n", kXyz + size + "1 2 abc\n",
          kXyz + "DATA ascii\n1 2 3\n", kXyz + "POINTS -1\nDATA ascii\n1 2 3\n",
          kXyz + "POINTS 99999999999999\nDATA ascii\n1 2 3\n",
          kXyz + "POINTS 99999999999999\nDATA binary\n1 2 3\n",
          kXyz + "POINTS 1\nDATA packed\n1 2 3\n",
          fields + "x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\n" + size + "1 2\n",
          fields + "x y z\nSIZE 4 4\nTYPE F F F\nCOUNT 1 1 1\n" + size + "1 2 3\n",
          fields + "x y z\nSIZE 4 4 3\nTYPE F F F\nCOUNT 1 1 1\n" + size + "1 2 3\n",
          fields + "x y z\nSIZE 4 4 4\nTYPE F F X\nCOUNT 1 1 1\n" + size + "1 2 3\n",
          fields + "x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 -1\n" + size + "1 2 3\n"}) {
        test::writeText(folder / "bad.pcd", text);
        EXPECT_NE(messageOf(folder / "bad.pcd").find("bad.pcd"), std::string::npos) << text;
    }
    EXPECT_NE(messageOf(folder / "missing.pcd"), "");
    EXPECT_NE(messageOf(folder.path().string()), "");
    EXPECT_THROW(map::savePcd(somePoints(), folder / "no/such/folder.pcd"), Error);
}
}  // namespace
