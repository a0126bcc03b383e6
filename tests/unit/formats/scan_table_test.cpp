#include "delio/formats/scan_table.h"

#include <gtest/gtest.h>

#include "delio/core/error.h"
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
    void write(const std::vector<io::ScanRow>& rows, const std::string& name) const {
        io::writeScanTable(
            rows.size(), [&](std::size_t i) { return rows[i]; }, folder_ / name);
    }
    void expectUnwritable(const std::vector<io::ScanRow>& rows) const {
        EXPECT_THROW(write(rows, "unlike.csv"), Error);
        EXPECT_FALSE(std::filesystem::exists(folder_ / "unlike.csv"));
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

TEST_F(ScanTable, IsReadAsItWasWritten) {
    const std::vector<io::ScanRow> rows = {
        {2, 1.5, {{"points", "120000"}, {"read_ms", "3.250"}}, false, ""},
        {5, 1317000000.1234567, {{"points", "7"}, {"read_ms", "0.100"}}, true, "few, of\r\nall"}};
    write(rows, "scans.csv");
    EXPECT_EQ(test::readText(folder_ / "scans.csv"),
              "scan,stamp_s,points,read_ms,predicted,reason\n"
              "2,1.5000000,120000,3.250,0,\n"
              "5,1317000000.1234567,7,0.100,1,few; of  all\n");
    const auto table = io::readScanTable(folder_ / "scans.csv");
    EXPECT_EQ(table.scans, (std::vector<std::size_t>{2, 5}));
    EXPECT_EQ(table.stamps_s, (std::vector<double>{1.5, 1317000000.1234567}));
    EXPECT_EQ(table.predicted, (std::vector<bool>{false, true}));
}

TEST_F(ScanTable, OfNoScansIsAHeading) {
    write({}, "scans.csv");
    EXPECT_EQ(test::readText(folder_ / "scans.csv"), "scan,stamp_s,predicted,reason\n");
    EXPECT_TRUE(io::readScanTable(folder_ / "scans.csv").scans.empty());
}

TEST_F(ScanTable, EveryRowHasTheSameColumns) {
    const io::ScanRow first{1, 0, {{"points", "5"}, {"lines", "2"}}, false, ""};
    expectUnwritable({first, {2, 1, {{"points", "5"}}, false, ""}});
    expectUnwritable({first, {2, 1, {{"lines", "2"}, {"points", "5"}}, false, ""}});
}
}  // namespace
