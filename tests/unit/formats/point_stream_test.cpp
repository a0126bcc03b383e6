// Points of a cloud, one after the other.
#include "formats/point_stream.h"

#include "cloud_files.h"
#include "formats/las.h"

namespace {
using namespace delio;
using namespace delio::cloud_test;
using Points = std::vector<Eigen::Vector3d>;

class PointStream : public testing::Test {
 protected:
    std::string file(const std::string& name, const std::string& text) const {
        test::writeText(folder_ / name, text);
        return folder_ / name;
    }
    static Points pointsIn(const std::string& path) {
        Points points;
        io::forEachPoint(path, [&](const Eigen::Vector3d& point) { points.push_back(point); });
        return points;
    }
    void expectRefused(const std::string& path, const std::vector<std::string>& words) const {
        expectError(errorOf([&] { pointsIn(path); }), words);
    }

    const Points wanted_{{456789.123, 5412345.678, 312.25}, {456790.5, 5412346, 312.5}};
    const std::string rows_ =
        "7 456789.123 5412345.678 312.25\n7 nan 0 0\n7 456790.5 5412346 312.5\n";
    test::TemporaryFolder folder_;
};

std::string ply(const std::string& format, const std::string& count) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + count +
           "\nproperty int id\nproperty double x\nproperty double y\nproperty double z\n"
           "end_header\n";
}
std::string pcd(const std::string& data, const std::string& count) {
    return "VERSION 0.7\nFIELDS id x y z\nSIZE 4 8 8 8\nTYPE I F F F\nCOUNT 1 1 1 1\nWIDTH " +
           count + "\nHEIGHT 1\nPOINTS " + count + "\nDATA " + data + "\n";
}
std::string bytesOf(const Points& points) {
    std::string bytes;
    for (const auto& point : points) {
        bytes += std::string(4, '\1');
        bytes.append(reinterpret_cast<const char*>(point.data()), 24);
    }
    return bytes;
}

TEST_F(PointStream, DoublesOfEveryFormat) {
    EXPECT_EQ(pointsIn(file("a.ply", ply("ascii", "3") + rows_)), wanted_);
    EXPECT_EQ(pointsIn(file("b.ply", ply("binary_little_endian", "2") + bytesOf(wanted_))),
              wanted_);
    EXPECT_EQ(pointsIn(file("a.pcd", pcd("ascii", "3") + rows_)), wanted_);
    EXPECT_EQ(pointsIn(file("b.pcd", pcd("binary", "2") + bytesOf(wanted_))), wanted_);
}

TEST_F(PointStream, LasWithItsCoordinateSystem) {
    const std::string path = folder_ / "a.las";
    io::LasFile header;
    header.wkt = "PROJCS[\"UTM\"]";
    io::saveLas(
        header, wanted_.size(),
        [&](std::size_t i, io::LasPoint& point) { point.position = wanted_[i]; }, path);
    Points points;
    EXPECT_EQ(io::forEachPoint(path, [&](const auto& point) { points.push_back(point); }),
              header.wkt);
    ASSERT_EQ(points.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_LT((points[i] - wanted_[i]).norm(), 1e-4);
}

TEST_F(PointStream, MoreThanOneBlock) {
    Points many;
    for (int i = 0; i < 150000; ++i) many.emplace_back(i, -i, 0.5 * i);
    EXPECT_EQ(pointsIn(file("b.pcd", pcd("binary", "150000") + bytesOf(many))), many);
}

TEST_F(PointStream, RefusesWhatIsNoWholeCloud) {
    expectRefused(file("a.ply", ply("ascii", "4") + rows_), {"a.ply", "3 of 4"});
    expectRefused(file("b.ply", ply("binary_little_endian", "9") + bytesOf(wanted_)), {"2 of 9"});
    expectRefused(file("c.ply", ply("binary_big_endian", "2") + bytesOf(wanted_)), {"big_endian"});
    expectRefused(file("a.pcd",
                       "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 1\nHEIGHT 1\n"
                       "POINTS 1\nDATA ascii\n1 2\n"),
                  {"no 'z'"});
    expectRefused(file("a.xyz", "1 2 3\n"), {"a.xyz", ".las"});
    expectRefused(folder_ / "missing.pcd", {"missing.pcd"});
    expectRefused(folder_ / "missing.las", {"missing.las"});
}
}  // namespace
