#include "delio/places/edit_graph.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "delio/core/error.h"
#include "town_map.h"

namespace {
using namespace delio;
using namespace delio::localisation_test;

/** A drive round the block and on, as an odometry that drifts has it, without loops. */
class DriftedTown : public testing::Test {
 protected:
    void SetUp() override {
        const auto truth = roundTheBlock(15);
        const auto poses = drifted(truth, 0.02, 0.001, 0);
        TownDrive drive(poses);
        drive.submaps = submapsOf(town(), truth, poses);
        drive.content.submaps = drive.submaps;
        drive.content.graph = chainOf(poses);
        last_ = drive.submaps.size() - 1;
        StoredMap::save(drive.content, path_);
    }
    std::string file(const std::string& text) const {
        test::writeText(folder_ / "edits.txt", text);
        return folder_ / "edits.txt";
    }
    /** The map that the edits make. */
    std::string edit(const std::string& text, const std::string& name = "edited.delio") const {
        const StoredMap map(path_);
        StoredMap::save(edited(map, readGraphEdits(file(text))), fileIn(folder_, name));
        return fileIn(folder_, name);
    }
    std::string refusalOf(const std::string& text) const {
        try {
            edit(text);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    std::string between(std::size_t from, std::size_t to) const {
        return std::to_string(from) + " " + std::to_string(to) + "\n";
    }
    /** How far the last submap is from where it truly is, as seen from the first. */
    double endError(const std::string& path) const {
        const StoredMap map(path);
        const auto truth = roundTheBlock(15);
        const auto &first = map.submaps().front(), &last = map.submaps().back();
        const auto& poses = map.graph().poses();
        return test::metresBetween(poses[first.key].inverse() * poses[last.key],
                                   truth[first.key].inverse() * truth[last.key]);
    }

    test::TemporaryFolder folder_;
    const std::string path_ = fileIn(folder_);
    std::size_t last_ = 0;
};

TEST_F(DriftedTown, AnEdgeIsAddedWhereBothShowOnePlace) {
    EXPECT_TRUE(submapEdges(StoredMap(path_)).empty());
    const std::string closed = edit("# by hand\n\nadd " + between(0, last_));
    const auto edges = submapEdges(StoredMap(closed));
    ASSERT_EQ(edges.size(), 1U);
    EXPECT_EQ(edges[0].from, 0U);
    EXPECT_EQ(edges[0].to, last_);
    EXPECT_GT(endError(path_), 0.5);
    EXPECT_LT(endError(closed), 0.2);
    // The same edits, the same map.
    const std::string again = edit("add " + between(0, last_), "again.delio");
    EXPECT_TRUE(test::readText(closed) == test::readText(again));
}

TEST_F(DriftedTown, AForbiddenEdgeIsGone) {
    const std::string text = "add " + between(0, last_) + "forbid " + between(last_, 0);
    EXPECT_TRUE(submapEdges(StoredMap(edit(text))).empty());
}

TEST_F(DriftedTown, RefusesWhatIsNotSo) {
    const std::string middle = between(0, last_ / 2);
    EXPECT_NE(refusalOf("add " + middle).find("not accepted"), std::string::npos);
    EXPECT_NE(refusalOf("forbid " + middle).find("no edge"), std::string::npos);
    EXPECT_NE(refusalOf("add 0 999\n").find("submaps, counted from 0"), std::string::npos);
    for (const char* text : {"add 0\n", "add 0 0\n", "add 0 1 2\n", "drop 0 1\n", "add a b\n"})
        EXPECT_NE(refusalOf(text).find("edits.txt', line 1"), std::string::npos) << text;
}

TEST_F(DriftedTown, EdgesAreListed) {
    const std::string csv = folder_ / "edges.csv";
    saveSubmapEdges(submapEdges(StoredMap(edit("add " + between(0, last_)))), csv);
    const std::string text = test::readText(csv);
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
    EXPECT_NE(text.find("\n0," + std::to_string(last_) + ","), std::string::npos) << text;
}
}  // namespace
