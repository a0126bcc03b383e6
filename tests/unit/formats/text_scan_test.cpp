// .txt and .csv files as scans.
#include "formats/text_cloud.h"

#include <cmath>

#include "cloud_files.h"

namespace {
using namespace delio;
using namespace delio::cloud_test;

class TextScan : public testing::Test {
 protected:
    io::CloudRecords read(const std::string& text) const {
        test::writeText(file_, text);
        return io::readTextScan(file_);
    }
    void refused(const std::string& text, const std::vector<std::string>& words) const {
        const auto error = errorOf([&] { read(text); });
        expectError(error, {file_.string()});
        expectError(error, words);
    }

    test::TemporaryFolder folder_;
    const fs::path file_ = folder_ / "a.csv";
};

TEST_F(TextScan, AnySeparators) {
    const std::vector<Xyzi> points{{1, 2, 3, 0.5F}, {-4, 5e-3F, 6, 1}};
    for (const char* text :
         {"1 2 3 0.5\n-4 5e-3 6 1\n", "1,2,3,0.5\r\n-4,5e-3,6,1\r\n", "1;2;3;0.5\n-4;5e-3;6;1",
          "\n 1\t2 , 3 ;\t.5 \n# a comment\n\n-4  +5e-3\t\t6 1\n",
          "\xEF\xBB\xBF"
          "1 2 3 .5\n-4 .005 6 1"})
        EXPECT_EQ(pointsOf(scanOf(read(text))), points) << text;
}

TEST_F(TextScan, ColumnsByTheirCount) {
    EXPECT_EQ(read("1 2 3\n").layout.fields.size(), 3U);
    const auto records = read("1 2 3 0.5 0.01 7\n1 2 nan 0.5 0.02 8\n");
    const Scan scan = scanOf(records);
    EXPECT_EQ(scan.rings, (std::vector<std::uint16_t>{7, 8}));
    EXPECT_TRUE(std::isnan(scan.points->getPointsBufferRef_z()[1]));
    EXPECT_EQ(records.layout.fields[4].name, "time");
    refused("1 2\n", {"line 1", "not 2"});
    refused("# one\n\n1 2 3 4 5 6 7\n", {"line 3", "not 7"});
}

TEST_F(TextScan, NumbersBeyondADouble) {
    const auto scan = scanOf(read("1e999 -1e-999 3\n-inf 1 1e-320\n"));
    EXPECT_TRUE(std::isnan(scan.points->getPointsBufferRef_x()[0]));
    EXPECT_EQ(scan.points->getPointsBufferRef_y()[0], 0);
    EXPECT_TRUE(std::isinf(scan.points->getPointsBufferRef_x()[1]));
    EXPECT_EQ(scan.points->getPointsBufferRef_z()[1], 0);
}

TEST_F(TextScan, ColumnsByTheirNames) {
    for (const char* names : {"laser,\"Z\",y,X,Intensity", "//laser Z Y X scalar_Intensity"})
        EXPECT_EQ(pointsOf(scanOf(read(std::string("# made by\n") + names + "\n9,3,2,1,0.5\n"))),
                  (std::vector<Xyzi>{{1, 2, 3, 0.5F}}))
            << names;
    refused("x y intensity\n1 2 3\n", {"line 1", "'z'"});
    refused("x y z i\n1 2 3\n", {"line 2", "3 numbers, not 4"});
}

TEST_F(TextScan, RefusesOtherLines) {
    refused("1 2 3\n4 5 6\n\n4 5 six\n", {"line 4", "numbers"});
    refused("1 2 3\n4 5 6m\n", {"line 2", "numbers"});
    refused("1 2 3\n4 5\n", {"line 2", "2 numbers, not 3"});
    refused("1 2 3\n4 5 6 7\n", {"line 2", "4 numbers, not 3"});
    refused("1,2,3\n4,,6\n", {"line 2"});
    refused("1,2,3\n,2,3\n", {"line 2"});
    refused("", {"no points"});
    refused("# nothing\n", {"no points"});
    refused("x y z\n", {"no points"});
    refused(std::string("\0\1\2\3", 4), {"line 1"});
    expectError(errorOf([&] { io::readTextScan(folder_ / "none.txt"); }), {"none.txt"});
}
}  // namespace
