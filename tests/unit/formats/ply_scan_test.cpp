// .ply files as scans.
#include "formats/ply.h"

#include <algorithm>

#include "cloud_files.h"

namespace {
using namespace delio;
using namespace delio::cloud_test;

std::string header(const std::string& format, const std::string& count,
                   const std::string& more = "", const std::string& after = "") {
    return "ply\nformat " + format + " 1.0\ncomment a scan\nelement vertex " + count +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n" +
           more + after + "end_header\n";
}

class PlyScan : public testing::Test {
 protected:
    io::CloudRecords read(const std::string& text) const {
        test::writeText(file_, text);
        return io::readPlyScan(file_.string());
    }
    void refused(const std::string& text, const std::vector<std::string>& words) const {
        const auto error = errorOf([&] { read(text); });
        expectError(error, {file_.string()});
        expectError(error, words);
    }

    test::TemporaryFolder folder_;
    const fs::path file_ = folder_ / "a.ply";
};

TEST_F(PlyScan, BinaryLittleEndian) {
    const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
    EXPECT_EQ(pointsOf(scanOf(read(header("binary_little_endian", "5", "", face) +
                                   rawPoints(pointsOf(2)) + "\3abcdefghijkl"))),
              pointsOf(2));
}

TEST_F(PlyScan, BinaryBigEndian) {
    std::string bytes = rawPoints(pointsOf(2));
    for (std::size_t i = 0; i < bytes.size(); i += 4)
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                     bytes.begin() + static_cast<std::ptrdiff_t>(i) + 4);
    EXPECT_EQ(pointsOf(scanOf(read(header("binary_big_endian", "5") + bytes))), pointsOf(2));
}

TEST_F(PlyScan, Ascii) {
    const Scan scan = scanOf(read(header("ascii", "2", "property uchar scalar_Ring\n") +
                                  "1 2 3 4 5\n-1.5 1e1 0 0.5 63\n3 0 1 2\n"));
    EXPECT_EQ(pointsOf(scan), (std::vector<Xyzi>{{1, 2, 3, 4}, {-1.5F, 10, 0, 0.5F}}));
    EXPECT_EQ(scan.rings, (std::vector<std::uint16_t>{5, 63}));
}

TEST_F(PlyScan, RefusesLyingHeaders) {
    const std::string bytes = rawPoints(pointsOf(2));
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        refused(header(format, "1000000000000") + bytes, {"1000000000000"});
        refused(header(format, "18446744073709551615") + bytes, {"18446744073709551615"});
        refused(header(format, "-1") + bytes, {"vertex"});
        refused(header(format, "5", "property list uchar int n\n") + bytes, {"list"});
        refused("ply\nformat " + std::string(format) + " 1.0\nelement vertex 1\nend_header\n1\n",
                {"of 1"});
    }
    refused(header("binary_little_endian", "5") + bytes.substr(1), {"4 of 5"});
    refused(header("ascii", "2") + "1 2 3 4\n1 2 3\n3 3 3", {"1 of 2"});
    refused(header("binary_middle_endian", "5") + bytes, {"binary_middle_endian"});
}

TEST_F(PlyScan, RefusesWhatIsNoPly) {
    refused("", {"empty"});
    refused("# .PCD\n", {"header"});
    refused(header("ascii", "2").substr(0, 60), {"header"});
    refused("ply\nformat ascii 1.0\nelement face 1\nproperty float x\nend_header\n1\n", {"vertex"});
    expectError(errorOf([&] { io::readPlyScan((folder_ / "none.ply").string()); }), {"none.ply"});
}
}  // namespace
