#include "delio/files/output.h"

#include <gtest/gtest.h>

#include <ostream>

#include "delio/core/error.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;

class OutputFile : public ::testing::Test {
 protected:
    const test::TemporaryFolder folder_;
    const std::string path_ = folder_ / "out.txt";

    /** What replaceFile() says; afterwards only what was there before may be there. */
    std::string faultOf(const std::function<bool(const std::string&)>& write) {
        test::writeText(path_, "old");
        std::string fault;
        try {
            io::replaceFile(path_, write);
        } catch (const Error& e) {
            fault = e.what();
        }
        EXPECT_EQ(test::readText(path_), "old");
        EXPECT_EQ(test::namesIn(folder_.path()), std::vector<std::string>{"out.txt"});
        return fault;
    }
};

TEST_F(OutputFile, IsReplacedWholeUnderATemporaryNameOfTheSameKind) {
    test::writeText(path_, "old");
    io::replaceFile(path_, [&](const std::string& temporary) {
        EXPECT_NE(temporary, path_);
        EXPECT_EQ(std::filesystem::path(temporary).extension(), ".txt");
        EXPECT_EQ(test::readText(path_), "old") << "untouched until the new one is whole";
        test::writeText(temporary, "new");
        return true;
    });
    EXPECT_EQ(test::readText(path_), "new");
    EXPECT_EQ(test::namesIn(folder_.path()), std::vector<std::string>{"out.txt"});
}

TEST_F(OutputFile, AFailedWriterLeavesWhatWasThere) {
    EXPECT_NE(faultOf([](const std::string& temporary) {
                  test::writeText(temporary, "half");
                  return false;
              }).find(path_),
              std::string::npos);
    EXPECT_EQ(faultOf([](const std::string& temporary) -> bool {
                  test::writeText(temporary, "half");
                  throw Error("a message of its own");
              }),
              "a message of its own");
    EXPECT_NE(faultOf([](const std::string& temporary) -> bool {
                  test::writeText(temporary, "half");
                  throw std::runtime_error("something else");
              }).find("something else"),
              std::string::npos);
    EXPECT_THROW(
        io::replaceTextFile(path_, [](std::ostream& out) { out.setstate(std::ios::badbit); }),
        Error);
    EXPECT_EQ(test::readText(path_), "old");
}

TEST_F(OutputFile, WhereNothingCanBeWrittenThePathIsNamed) {
    for (const std::string path : {"none/out.txt", "folder"}) {
        std::filesystem::create_directories(folder_ / "folder/within");
        try {
            io::replaceTextFile(folder_ / path, [](std::ostream& out) { out << 1; });
            FAIL() << path;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find(path), std::string::npos) << e.what();
        }
    }
    EXPECT_EQ(test::namesIn(folder_.path()), (std::vector<std::string>{"folder", "folder/within"}));
}
}  // namespace
