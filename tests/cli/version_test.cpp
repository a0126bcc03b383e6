// share/scripts/version, in a copy of what it reads.
#include <gtest/gtest.h>

#include "command.h"
#include "test_data.h"

namespace {
using namespace delio;
namespace fs = std::filesystem;

class Version : public testing::Test {
 protected:
    void SetUp() override {
        const fs::path root = test::profileFolder().parent_path().parent_path();
        for (const char* part : {"CMakeLists.txt", "CHANGELOG.md", "CITATION.cff", "debian",
                                 "libdelio/include", "share/scripts/version"}) {
            fs::create_directories((folder_ / part).parent_path());
            fs::copy(root / part, folder_ / part, fs::copy_options::recursive);
        }
        test::writeText(folder_ / "share/headers.sha256", "");
        EXPECT_EQ(run("--release").exitCode, 0);
    }
    test::CommandResult run(const std::string& option = "") const {
        return test::runTool(folder_ / "share/scripts/version",
                             option.empty() ? std::vector<std::string>() : std::vector{option});
    }
    void addToHeader(const std::string& line) const {
        const auto header = folder_ / "libdelio/include/delio/core/error.h";
        test::writeText(header, test::readText(header) + line + "\n");
    }

    test::TemporaryFolder folder_;
};

TEST_F(Version, HasToBeRaisedWithPublicHeaders) {
    addToHeader("// A comment.");
    EXPECT_EQ(run().exitCode, 0) << run().err;
    addToHeader("struct Other {};");
    const auto changed = run();
    EXPECT_EQ(changed.exitCode, 1);
    EXPECT_NE(changed.err.find("--bump"), std::string::npos) << changed.err;

    const auto raised = run("--bump");
    EXPECT_EQ(raised.exitCode, 0) << raised.err;
    addToHeader("struct More {};");
    EXPECT_EQ(run().exitCode, 0) << run().err;
    EXPECT_EQ(run("--release").exitCode, 0) << run().err;
    addToHeader("struct Late {};");
    EXPECT_EQ(run().exitCode, 1);
}

TEST_F(Version, IsTheSameEverywhere) {
    const auto file = folder_ / "CITATION.cff";
    test::writeText(file, test::readText(file) + "version: 9.9.9\n");
    const auto result = run();
    EXPECT_EQ(result.exitCode, 1);
    EXPECT_NE(result.err.find("CITATION.cff"), std::string::npos) << result.err;
}
}  // namespace
