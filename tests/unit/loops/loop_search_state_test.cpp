#include <gtest/gtest.h>

#include "delio/loops/close_loops.h"
#include "states.h"
#include "test_data.h"
#include "town.h"

// What was found of a drive's loops is stored, and the search goes on.
namespace {
using namespace delio;
using namespace delio::loops_test;
using test::stateOf;

void expectSame(const loops::LoopSearch& a, const loops::LoopSearch& b) {
    ASSERT_EQ(a.candidates().size(), b.candidates().size());
    for (std::size_t i = 0; i < a.candidates().size(); ++i) {
        const auto &one = a.candidates()[i], &other = b.candidates()[i];
        EXPECT_EQ(one.from, other.from);
        EXPECT_EQ(one.to, other.to);
        EXPECT_EQ(one.closure.reason, other.closure.reason);
        EXPECT_EQ(one.closure.level.matrix(), other.closure.level.matrix());
        EXPECT_EQ(one.closure.increment.covariance, other.closure.increment.covariance);
    }
}

TEST(LoopSearchState, GoesOnAfterAnySubmap) {
    const auto truth = roundTheBlock(15), believed = drifted(truth, 0.05, 0.001, 0.01);
    const auto submaps = submapsOf(town(), truth, believed);
    ASSERT_GT(submaps.size(), 4U);
    const test::TemporaryFolder folder;
    const auto made = [&] { return loops::LoopSearch({}, {}, folder.path().string(), true); };
    auto whole = made();
    std::vector<std::string> states;
    for (const auto& submap : submaps) {
        states.push_back(stateOf(whole));
        whole.add(submap, believed[submap.key]);
    }
    const auto last = stateOf(whole);
    // Backwards: the file of the submaps is cut each time.
    for (const std::size_t count : {submaps.size() - 1, submaps.size() / 2, std::size_t{1}}) {
        SCOPED_TRACE(count);
        auto again = made();
        test::restore(again, states[count]);
        EXPECT_TRUE(stateOf(again) == states[count]);
        for (std::size_t i = count; i < submaps.size(); ++i)
            again.add(submaps[i], believed[submaps[i].key]);
        expectSame(again, whole);
        EXPECT_TRUE(stateOf(again) == last);
        auto searched = made();
        test::restore(searched, last);
        const auto one = loops::closeLoops(chainOf(believed), again, {}),
                   other = loops::closeLoops(chainOf(believed), searched, {});
        EXPECT_GT(one.accepted, 0U);
        EXPECT_EQ(one.accepted, other.accepted);
        for (std::size_t i = 0; i < believed.size(); ++i)
            ASSERT_EQ(one.graph.poses()[i].matrix(), other.graph.poses()[i].matrix()) << i;
    }
}
}  // namespace
