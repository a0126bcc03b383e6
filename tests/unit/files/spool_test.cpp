#include "files/spool.h"

#include <gtest/gtest.h>

#include "delio/core/error.h"

namespace delio::io {
TEST(Spool, GivesBackWhatWasPutAsideInAnyOrder) {
    Spool spool("", "the scans", "--no-map");
    const Spool::Floats first{1, 2, 3}, second{4};
    const Spool::Place a = spool.append(first);
    const Spool::Place b = spool.append(second);
    EXPECT_EQ(spool.read(b), second);
    EXPECT_EQ(spool.read(a), first);
    EXPECT_EQ(spool.read(spool.append(first)), first);
}

TEST(Spool, NothingIsPutAsideAsNothing) {
    Spool spool("", "the scans", "--no-map");
    const Spool::Place nothing = spool.append(Spool::Floats{});
    EXPECT_TRUE(spool.read(nothing).empty());
    const Spool::Floats cloud{1, 2};
    EXPECT_EQ(spool.read(spool.append(cloud)), cloud);
    EXPECT_TRUE(spool.read(nothing).empty());
}

TEST(Spool, AFolderThatIsMissingIsNamed) {
    try {
        Spool("/nowhere/at/all", "the scans", "--no-map");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("/nowhere/at/all"), std::string::npos);
    }
}
}  // namespace delio::io
