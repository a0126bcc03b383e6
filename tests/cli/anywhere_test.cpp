#include "anywhere.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "test_data.h"

// A tenth of the table "Anywhere" of share/doc/method/accuracy.md, half as long: sensors of few and
// of many beams, in scenes rich and poor in surfaces, from rest and at speed, upright and turned.
namespace {
using namespace delio;
using test::Cell;

/** Every 149th of 288 in a circle: the stride under which values, and pairs of them, are met most
 *  evenly. Nothing was tuned on these seeds. */
std::vector<Cell> tenth() {
    const auto all = test::cellsOf({201, 202, 203});
    std::vector<Cell> some;
    for (std::size_t i = 0; i < 29; ++i) some.push_back(all[149 * i % all.size()]);
    return some;
}

/** Where nothing shows the way: what is asked of DeLiO is that it says so. */
std::vector<Cell> tunnels() {
    return {{"vlp16", "tunnel", "rest", "pitched", 201},
            {"hdl32e", "tunnel", "moving", "rolled", 202},
            {"os1-64", "tunnel", "rest", "upright", 203},
            {"hdl64e", "tunnel", "moving", "pitched", 201}};
}

std::string nameOf(const testing::TestParamInfo<Cell>& cell) {
    std::string name = cell.param.name();
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

test::CellRun runOf(const Cell& cell, const std::string& profile = "accurate") {
    const test::TemporaryFolder folder;
    return test::runOn(test::makeDrive(cell, 30, folder.path()), folder / "out", profile);
}

class Anywhere : public testing::TestWithParam<Cell> {};
INSTANTIATE_TEST_SUITE_P(Tenth, Anywhere, testing::ValuesIn(tenth()), nameOf);
INSTANTIATE_TEST_SUITE_P(Elsewhere, Anywhere,
                         testing::Values(Cell{"os1-64", "forest", "", "upright", 9},
                                         Cell{"vlp16", "forest", "", "upright", 204},
                                         Cell{"hdl32e", "indoor", "", "upright", 204}),
                         nameOf);
// Swings of up to 25 deg between two scans, which no prediction foresees.
INSTANTIATE_TEST_SUITE_P(Handheld, Anywhere,
                         testing::Values(Cell{"vlp16", "indoor", "", "upright", 204, "handheld"},
                                         Cell{"hdl32e", "urban", "", "upright", 205, "handheld"},
                                         Cell{"vlp16", "forest", "", "upright", 205, "handheld"},
                                         Cell{"os1-64", "forest", "", "upright", 206, "handheld"}),
                         nameOf);

TEST_P(Anywhere, IsRegistered) {
    const auto run = runOf(GetParam());
    EXPECT_LT(run.endError_percent, 1);
    EXPECT_EQ(run.predicted, 0U);
    EXPECT_FALSE(run.lostInSilence());
}

// Where lines alone stood still and said nothing.
class AnywherePaper : public testing::TestWithParam<Cell> {};
INSTANTIATE_TEST_SUITE_P(Highways, AnywherePaper,
                         testing::Values(Cell{"vlp16", "highway", "rest", "upright", 201},
                                         Cell{"hdl32e", "highway", "moving", "rolled", 202},
                                         Cell{"os1-64", "highway", "rest", "pitched", 203},
                                         Cell{"vlp16", "urban", "moving", "rolled", 203}),
                         nameOf);

TEST_P(AnywherePaper, IsRegistered) {
    const auto run = runOf(GetParam(), "paper-extended");
    EXPECT_LT(run.endError_percent, 5);
    EXPECT_EQ(run.predicted, 0U);
    EXPECT_FALSE(run.lostInSilence());
}

class AnywhereLost : public testing::TestWithParam<Cell> {};
INSTANTIATE_TEST_SUITE_P(Tunnels, AnywhereLost, testing::ValuesIn(tunnels()), nameOf);

TEST_P(AnywhereLost, IsNotLostInSilence) {
    const auto run = runOf(GetParam());
    EXPECT_FALSE(run.lostInSilence()) << run.endError_percent << " %";
}
}  // namespace
