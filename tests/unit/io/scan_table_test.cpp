#include "delio/io/scan_table.h"

#include <gtest/gtest.h>

#include "delio/error.h"
#include "test_data.h"

namespace {
using namespace delio;

class ScanTable : public testing::Test {
 protected:
    io::ScanTable tableOf(const std::string& text) const {
        test::writeText(folder_ / "scans.csv", text);
        return io::readScanTable(folder_ / "scans.csv");
    }
    std::string faultOf(const std::string& text) const {
        try {
            tableOf(text);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    test::TemporaryFolder folder_;
};

TEST_F(ScanTable, TakesItsColumnsWhereverTheyAre) {
    const auto table = tableOf(
        "scan,other,predicted,stamp_s,reason\n"
        "3,x,0,1.5,\n"
        "5,y,1,1.7,too few normals, and lines\n");
    EXPECT_EQ(table.scans, (std::vector<std::size_t>{3, 5}));
    EXPECT_EQ(table.stamps_s, (std::vector<double>{1.5, 1.7}));
    EXPECT_EQ(table.predicted, (std::vector<bool>{false, true}));
}

TEST_F(ScanTable, NamesWhatIsWrong) {
    EXPECT_NE(faultOf("scan,stamp_s\n1,2\n").find("no column 'predicted'"), std::string::npos);
    EXPECT_NE(faultOf("").find("no column 'scan'"), std::string::npos);
    const std::string heading = "scan,stamp_s,predicted\n";
    EXPECT_NE(faultOf(heading + "1,2,0\n2,x,0\n").find("line 3: 'stamp_s'"), std::string::npos);
    EXPECT_NE(faultOf(heading + "1,nan,0\n").find("line 2: 'stamp_s'"), std::string::npos);
    EXPECT_NE(faultOf(heading + "1,2\n").find("line 2: 'predicted'"), std::string::npos);
    EXPECT_NE(faultOf(heading + "1,2,0\n1,3,0\n").find("line 3"), std::string::npos);
    EXPECT_NE(faultOf(heading + "-1,2,0\n").find("line 2"), std::string::npos);
    EXPECT_THROW(io::readScanTable(folder_ / "none.csv"), Error);
}
}  // namespace
