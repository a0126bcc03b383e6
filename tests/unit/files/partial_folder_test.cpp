#include "delio/files/output.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <optional>

#include "delio/core/error.h"
#include "test_data.h"
#include "toy_drive.h"

namespace {
using namespace delio;
using test::namesIn;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

class PartialFolder : public testing::Test {
 protected:
    const test::TemporaryFolder folder_;

    void write(const fs::path& in, const Names& names, const std::string& text) const {
        for (const auto& name : names) {
            fs::create_directories((in / name).parent_path());
            test::writeText(in / name, text);
        }
    }
    std::string textOf(const std::string& name) const { return test::readText(folder_ / name); }
};

TEST_F(PartialFolder, IsPrivateAndGoesWithWhatIsInIt) {
    fs::path path, other;
    {
        const io::PartialFolder one(folder_.path(), "out"), two(folder_.path(), "out");
        path = one.path(), other = two.path();
        EXPECT_NE(path, other);
        EXPECT_EQ(fs::status(path).permissions(), fs::perms(0700));
        write(path, {"folder/file"}, "x");
    }
    EXPECT_EQ(namesIn(folder_.path()), Names());
    try {
        const io::PartialFolder nowhere(folder_ / "none", "none/out");
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("'none/out'"), std::string::npos) << e.what();
    }
}

TEST_F(PartialFolder, AllComesInPlaceOrNothing) {
    write(folder_.path(), {"mark", "images/0", "images/1", "gone", "else"}, "old");
    {
        io::PartialFolder partial(folder_.path(), "out");
        write(partial.path(), {"mark", "images/0", "else/file", "made/file"}, "new");
        // "else" is a file.
        EXPECT_THROW(partial.putInPlace({"mark", "images", "gone", "else/file", "made/file"}),
                     Error);
        EXPECT_FALSE(fs::exists(folder_ / "made"));
        for (const char* name : {"mark", "images/0", "images/1", "gone", "else"})
            EXPECT_EQ(textOf(name), "old") << name;
        fs::remove_all(partial.path() / "else");
        partial.putInPlace({"mark", "images", "gone", "none"});
    }
    EXPECT_EQ(namesIn(folder_.path()), (Names{"else", "images", "images/0", "mark"}));
    EXPECT_EQ(textOf("mark") + textOf("images/0") + textOf("else"), "newnewold");
}

TEST_F(PartialFolder, FilesWithinFoldersComeInPlaceAloneAndOthersStay) {
    write(folder_.path(), {"mark", "a/0", "a/mine", "b/0"}, "old");
    {
        io::PartialFolder partial(folder_.path(), "out");
        write(partial.path(), {"mark", "a/0", "c/0"}, "new");
        partial.putInPlace({"mark", "a/0", "b/0", "c/0"});
    }
    EXPECT_EQ(namesIn(folder_.path()), (Names{"a", "a/0", "a/mine", "b", "c", "c/0", "mark"}));
    EXPECT_EQ(textOf("mark") + textOf("a/0") + textOf("c/0") + textOf("a/mine"), "newnewnewold");
}

TEST_F(PartialFolder, AFileTakesNoFoldersPlace) {
    write(folder_.path(), {"mark", "times.txt/mine"}, "old");
    io::PartialFolder partial(folder_.path(), "out");
    write(partial.path(), {"mark", "times.txt"}, "new");
    EXPECT_THROW(partial.putInPlace({"mark", "times.txt"}), Error);
    EXPECT_EQ(textOf("mark") + textOf("times.txt/mine"), "oldold");
}

TEST_F(PartialFolder, MessagesNameWhatItWasToBecome) {
    const io::PartialFolder partial(folder_.path(), "out");
    EXPECT_EQ(partial.asInPlace("cannot write '" + (partial.path() / "a.ply").string() + "'"),
              "cannot write '" + (folder_ / "a.ply").string() + "'");
}

TEST_F(PartialFolder, ALockIsForOneAndLeavesNothing) {
    const std::string file = folder_ / "d.rawlog";
    fs::create_directory(folder_ / "back");
    for (const auto& output : {file, (folder_ / "back").string()}) {
        std::optional<io::OutputLock> lock(output);
        EXPECT_THROW(io::OutputLock{output}, Error) << output;
        const io::OutputLock other(folder_ / "e.rawlog");
        lock.reset();
        EXPECT_NO_THROW(io::OutputLock{output}) << output;
    }
    EXPECT_EQ(namesIn(folder_.path()), Names{"back"});
    EXPECT_EQ(namesIn(folder_ / "back"), Names());
}

TEST_F(PartialFolder, ALockIsAFile) {
    const fs::path pipe = folder_ / ".partial-d.rawlog.lock";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THROW(io::OutputLock{folder_ / "d.rawlog"}, Error);
    EXPECT_TRUE(fs::is_fifo(pipe)) << "it is somebody else's";
}

TEST_F(PartialFolder, AFolderThatWasMadeForNothingIsTakenAway) {
    for (const bool used : {false, true}) {
        {
            const io::TargetFolder target(folder_ / "made");
            EXPECT_THROW(io::TargetFolder{folder_ / "made"}, Error) << "it is being written";
            if (used) write(folder_ / "made", {"file"}, "new");
        }
        EXPECT_EQ(fs::exists(folder_ / "made"), used);
    }
    { const io::TargetFolder there(folder_ / "made"); }
    EXPECT_EQ(textOf("made/file"), "new");
    EXPECT_THROW(io::TargetFolder{folder_ / "made/file"}, Error);
}
}  // namespace
