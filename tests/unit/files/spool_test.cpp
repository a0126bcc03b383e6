#include "files/spool.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "delio/core/error.h"
#include "test_data.h"

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

TEST(Spool, AFileThatStaysIsGoneOnWithFromWhereItWas) {
    const test::TemporaryFolder folder;
    const std::string path = (folder / "map.spool").string();
    const Spool::Floats first{1, 2, 3}, second{4}, third{5, 6};
    std::uint64_t end = 0;
    Spool::Place a, b;
    {
        Spool spool = Spool::named(path, "the scans", "--no-map");
        a = spool.append(first);
        end = spool.kept();
        spool.append(second);
    }
    {
        Spool spool = Spool::again(path, "the scans", "--no-map", end);
        EXPECT_EQ(std::filesystem::file_size(path), end);
        b = spool.append(third);
        EXPECT_EQ(spool.read(a), first);
        EXPECT_EQ(spool.read(b), third);
        EXPECT_EQ(spool.kept(), std::filesystem::file_size(path));
    }
    Spool::named(path, "the scans", "--no-map");  // begins anew
    EXPECT_EQ(std::filesystem::file_size(path), 0U);
}

TEST(Spool, AFileThatIsShorterThanItWasIsNamed) {
    const test::TemporaryFolder folder;
    const std::string path = (folder / "map.spool").string();
    for (const bool isThere : {false, true}) {
        if (isThere) Spool::named(path, "the scans", "--no-map").append({1});
        try {
            Spool::again(path, "the scans", "--no-map", 8);
            FAIL();
        } catch (const Error& error) {
            const std::string what = error.what();
            EXPECT_NE(what.find(path), std::string::npos) << what;
            EXPECT_NE(what.find("begin the drive again"), std::string::npos) << what;
        }
    }
}

TEST(Spool, AFileWithoutANameCannotBeKept) {
    EXPECT_THROW(Spool("", "the scans", "--no-map").kept(), Error);
}
}  // namespace delio::io
