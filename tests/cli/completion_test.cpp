// share/completions/delio, as bash asks it.
#include <gtest/gtest.h>

#include <set>

#include "help_lines.h"
#include "tools.h"

namespace {
using namespace delio;
using test::runTool;
namespace fs = std::filesystem;

constexpr const char* kLibrary = "/usr/share/bash-completion/bash_completion";

class Completion : public testing::Test {
 protected:
    void SetUp() override {
        if (!fs::exists(kLibrary)) {
            if (test::dataIsRequired()) FAIL() << "bash-completion is not installed";
            GTEST_SKIP() << "bash-completion is not installed";
        }
        fs::create_directory(folder_ / "folder");
        test::writeText(folder_ / "file.txt", "");
    }

    /** What there is to complete the last of `words` with, in a folder with a file and a folder. */
    std::set<std::string> of(const std::string& tool, const std::vector<std::string>& words) const {
        const fs::path share = test::profileFolder().parent_path();
        std::string line = tool, list = "'" + tool + "'";
        for (const auto& word : words) {
            line += " " + word;
            // As readline has it: '=' is a word of its own.
            list += " '" + std::regex_replace(word, std::regex("="), "' = '") + "'";
        }
        const auto result = runTool(
            "bash", {"--norc", "-c",
                     "cd '" + folder_.path().string() + "'; PATH='" +
                         fs::path(test::toolPath(tool)).parent_path().string() + "':$PATH; . " +
                         kLibrary + "; . '" + (share / "completions/delio").string() +
                         "'; compopt() { :; }; COMP_WORDS=(" + list +
                         "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMP_LINE='" + line +
                         "'; COMP_POINT=${#COMP_LINE}; $(complete -p " + tool +
                         " | sed -E 's/.*-F ([^ ]+).*/\\1/') " + tool +
                         "; printf '%s\\n' \"${COMPREPLY[@]}\""});
        EXPECT_EQ(result.err, "");
        std::istringstream out(result.out);
        std::set<std::string> replies;
        for (std::string reply; std::getline(out, reply);)
            if (!reply.empty()) replies.insert(reply);
        return replies;
    }
    using Replies = std::set<std::string>;

 private:
    test::TemporaryFolder folder_;
};

TEST_F(Completion, OfOptions) {
    for (const auto& tool : test::kTools) {
        Replies all;
        for (const auto& option : test::helpOptionsOf(tool))
            all.insert(option.name + (option.value.empty() ? "" : "="));
        EXPECT_EQ(of(tool, {"--"}), all) << tool;
    }
    EXPECT_EQ(of("delio-slam", {"-i", "in", "--ground"}),
              (Replies{"--ground-truth=", "--ground-truth-frame="}));
}

TEST_F(Completion, OfValues) {
    const Replies profiles{"accurate", "paper", "paper-extended", "paper-literal"};
    EXPECT_EQ(of("delio-slam", {"--profile", ""}), profiles);
    EXPECT_EQ(of("delio-slam", {"--profile=pa"}),
              (Replies{"paper", "paper-extended", "paper-literal"}));
    EXPECT_EQ(of("delio-eval", {"-f", ""}), (Replies{"table", "tsv"}));
    EXPECT_EQ(of("synth2rawlog", {"--scene", "in"}), Replies{"indoor"});
    EXPECT_EQ(of("delio-slam", {"--threads", ""}), Replies{});
}

TEST_F(Completion, OfFiles) {
    const Replies folders{"folder"}, both{"file.txt", "folder"};
    EXPECT_EQ(of("delio-slam", {"-i", ""}), both);
    EXPECT_EQ(of("delio-slam", {"--input=fi"}), Replies{"file.txt"});
    EXPECT_EQ(of("delio-slam", {"--output", ""}), folders);
    EXPECT_EQ(of("delio-eval", {"--ref", ""}), both);
    EXPECT_EQ(of("delio-eval", {"--est", "ours=fi"}), Replies{"file.txt"});
    EXPECT_EQ(of("delio-map", {"-o", ""}), both);
}

TEST_F(Completion, OfKeys) {
    EXPECT_EQ(of("delio-slam", {"--set", "graph.skip"}), Replies{"graph.skip_edges="});
    EXPECT_EQ(of("delio-slam", {"--set", "scan.desk"}), Replies{"scan.deskew="});
    EXPECT_EQ(of("delio-slam", {"--set=scan.desk"}), Replies{"scan.deskew="});
    EXPECT_EQ(of("delio-slam", {"--set", "scan.deskew="}), Replies{});
    EXPECT_EQ(of("delio-slam", {"--set", "line_cloud."}), Replies{});
    for (const auto& profile :
         {std::vector<std::string>{"--profile", "paper"}, {"--profile=paper"}}) {
        auto words = profile;
        words.insert(words.end(), {"--set", "line_cloud.sect"});
        EXPECT_EQ(of("delio-slam", words), Replies{"line_cloud.sectors="});
    }
    EXPECT_EQ(of("delio-figures", {"--set", "line_cloud.sect"}), Replies{"line_cloud.sectors="});
}
}  // namespace
