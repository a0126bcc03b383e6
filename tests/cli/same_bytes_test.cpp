// The same bytes for any number of threads, on every processor, and from the configuration that a
// run left.
#include <gtest/gtest.h>
#include <mrpt/containers/yaml.h>

#include <map>
#include <string>
#include <vector>

#include "command.h"
#include "same_files.h"
#include "test_data.h"

namespace {
using namespace delio;

/** Twenty scans with road users and the vehicle's motion in them, three times. Returns scans.csv.
 */
std::map<std::string, std::vector<std::string>> expectSameBytes(const std::string& profile,
                                                                const std::string& scene) {
    const test::TemporaryFolder folder;
    const std::string drive = folder / "d.rawlog";
    const auto made = test::runTool("synth2rawlog", {"-o", drive, "--scene", scene, "--scans", "20",
                                                     "--movers", "8", "--distort"});
    EXPECT_EQ(made.exitCode, 0) << made.err;
    // The C library takes other functions on a processor that it is told is an older one.
    const auto into = [&](const std::string& name, const std::string& processor,
                          std::vector<std::string> more) {
        more.insert(more.begin(), {"GLIBC_TUNABLES=glibc.cpu.hwcaps=" + processor,
                                   test::toolPath("delio-slam"), "-i", drive, "-o", folder / name});
        const auto run = test::runTool("env", more);
        EXPECT_EQ(run.exitCode, 0) << run.err;
    };
    const std::string avx2 = "-AVX512F", sse2 = "-AVX512F,-AVX2,-AVX,-FMA,-FMA4";
    const std::string correction = "scan.vertical_correction_deg=0.1";
    into("one", "", {"--profile", profile, "--set", correction, "--threads", "1"});
    into("two", avx2, {"--profile", profile, "--set", correction, "--threads", "2"});
    into("fed", sse2, {"-c", folder / "one" / "config.ini", "--threads", "2"});
    test::expectSameResults(folder / "one", folder / "two");
    test::expectSameResults(folder / "one", folder / "fed");
    auto summary = mrpt::containers::yaml::FromFile((folder / "one" / "summary.yaml").string());
    EXPECT_EQ(summary["deskewed"].as<int>(), 20);
    EXPECT_EQ(summary["predicted"].as<int>(), 0);
    return test::csvColumns(folder / "one" / "scans.csv");
}

TEST(SameBytes, Accurate) {
    const auto scans = expectSameBytes("accurate", "rural");
    EXPECT_GT(std::stoi(scans.at("dynamic").back()), 100);
}

TEST(SameBytes, Paper) { expectSameBytes("paper", "urban"); }
}  // namespace
