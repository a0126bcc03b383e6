#include <fstream>

#include "bag_files.h"

namespace delio::bag_test {
TEST(BagContainers, GiveTheSameScans) {
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(7, container.kind));
        const auto reader = container.open({file.string(), "", "", ""});
        EXPECT_EQ(reader->label(), "/points");
        for (std::size_t i = 0; i < 7; ++i) {
            const auto scan = reader->next();
            ASSERT_TRUE(scan);
            expectScan(*scan, i);
            ASSERT_TRUE(reader->fraction());
            EXPECT_GT(*reader->fraction(), 0);
            EXPECT_LE(*reader->fraction(), 1);
        }
        EXPECT_FALSE(reader->next());
        EXPECT_FALSE(reader->next());
        EXPECT_EQ(reader->fraction(), 1);
        EXPECT_FALSE(reader->meta());
    }
}

TEST(BagContainers, SayWhatTheyAre) {
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(5, container.kind));
        const io::Recording recording = container.open({file.string(), "", "", ""})->recording();
        const std::string name = container.name;
        const std::string kind = name == "db3"    ? "ROS 2 bag"
                                 : name[0] == 'b' ? "ROS 1 bag"
                                                  : "MCAP";
        EXPECT_EQ(recording.kind, kind + ", topic /points");
        EXPECT_EQ(recording.sensor, "");
        EXPECT_FALSE(recording.motionCompensated);
        const bool counted = name.find("no index") + name.find("no summary") + 2 == 0;
        EXPECT_EQ(recording.scans, counted ? std::optional<std::size_t>(5) : std::nullopt);
    }
}

TEST(BagContainers, SkipCountsScans) {
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(4, container.kind));
        const auto reader = container.open({file.string(), "/points", "", ""});
        EXPECT_TRUE(reader->skip());
        EXPECT_TRUE(reader->skip());
        const auto scan = reader->next();
        ASSERT_TRUE(scan);
        expectScan(*scan, 2);
        EXPECT_TRUE(reader->skip());
        EXPECT_FALSE(reader->skip());
    }
}

TEST(BagContainers, EmptyBagsSaySo) {
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, {});
        expectHolds(faultOf(container.open, {file.string(), "", "", ""}), {"contains no messages"});
    }
}

TEST(BagContainers, ForeignAndMissingFilesAreErrors) {
    const test::TemporaryFolder folder;
    const auto foreign = folder / "foreign", empty = folder / "empty";
    test::writeText(foreign, "This is a text of some length that is no bag at all.\n");
    test::writeText(empty, "");
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        EXPECT_NE(faultOf(container.open, {foreign.string(), "", "", ""}), "");
        EXPECT_NE(faultOf(container.open, {empty.string(), "", "", ""}), "");
        expectHolds(faultOf(container.open, {(folder / "none").string(), "", "", ""}),
                    {"cannot be opened"});
    }
    test::writeText(foreign, "#ROSBAG V1.2\nand what was written then");
    expectHolds(faultOf(io::openRos1Bag, {foreign.string(), "", "", ""}), {"2.0"});
    test::writeText(foreign, "\x28\xB5\x2F\xFDpacked");
    expectHolds(faultOf(io::openRos2Database, {foreign.string(), "", "", ""}), {"decompress"});
}

TEST(BagContainers, DatabaseOfOtherTablesIsAnError) {
    const test::TemporaryFolder folder;
    const auto file = folder / "d.db3";
    test::writeDatabase(file, drive(1, Kind::kCdr));
    std::string bytes = test::readText(file);
    for (std::size_t at = bytes.find("topics"); at != std::string::npos;
         at = bytes.find("topics", at + 1))
        bytes.replace(at, 6, "topicz");
    test::writeText(file, bytes);
    expectHolds(faultOf(io::openRos2Database, {file.string(), "", "", ""}), {"topics"});
}

TEST(BagContainers, DatabaseIsReadInOrderOfTime) {
    const test::TemporaryFolder folder;
    const auto file = folder / "d.db3";
    BagContents bag = drive(5, Kind::kCdr);
    std::reverse(bag.messages.begin(), bag.messages.end());
    test::writeDatabase(file, bag);
    const Outcome outcome = readAll(io::openRos2Database, {file.string(), "", "", ""});
    EXPECT_EQ(outcome.fault, "");
    EXPECT_EQ(outcome.scans, 5U);
}

TEST(BagContainers, DatabaseThatDoesNotNameItsFormat) {
    const test::TemporaryFolder folder;
    const auto file = folder / "d.db3";
    BagContents bag = drive(3, Kind::kCdr);
    bag.encoding = "";
    test::writeDatabase(file, bag);
    EXPECT_EQ(readAll(io::openRos2Database, {file.string(), "", "", ""}).scans, 3U);
}

/** Halves of a drive in two files of a ROS 2 folder. */
void writeFolder(const std::filesystem::path& folder, bool mcap, const std::string& prefix) {
    const BagContents all = drive(6, Kind::kCdr);
    BagContents halves[2] = {all, all};
    halves[0].messages.resize(6);
    halves[1].messages.erase(halves[1].messages.begin(), halves[1].messages.begin() + 6);
    std::vector<std::string> names;
    for (int i = 0; i < 2; ++i) {
        const std::string name = "d_" + std::to_string(i) + (mcap ? ".mcap" : ".db3");
        if (mcap)
            writeMcap(folder / name, halves[i], "zstd");
        else
            test::writeDatabase(folder / name, halves[i]);
        names.push_back(prefix + name);
    }
    test::writeMetadata(folder, all, names);
}

TEST(BagContainers, FoldersFilesAreOneDrive) {
    for (const bool mcap : {false, true}) {
        const test::TemporaryFolder folder;
        writeFolder(folder.path(), mcap, mcap ? "older_name/" : "");
        const io::ScanSource source{folder.path().string(), "", "", ""};
        const auto reader = io::openRos2Folder(source);
        EXPECT_EQ(reader->recording().kind, "ROS 2 bag, topic /points");
        EXPECT_EQ(reader->recording().scans, 6U);
        const Outcome outcome = readAll(io::openRos2Folder, source);
        EXPECT_EQ(outcome.fault, "");
        EXPECT_EQ(outcome.scans, 6U);
    }
}

TEST(BagContainers, FoldersFaultsAreNamed) {
    const test::TemporaryFolder folder;
    const io::ScanSource source{folder.path().string(), "", "", ""};
    expectHolds(faultOf(io::openRos2Folder, source), {"metadata.yaml"});
    writeFolder(folder.path(), false, "");
    std::filesystem::remove(folder / "d_1.db3");
    const Outcome outcome = readAll(io::openRos2Folder, source);
    EXPECT_EQ(outcome.scans, 3U);
    expectHolds(outcome.fault, {"d_1.db3", "does not exist", "after 3 scans"});
    std::filesystem::remove(folder / "d_0.db3");
    expectHolds(faultOf(io::openRos2Folder, source), {"d_0.db3", "does not exist"});
    for (const char* text : {"- a\n- b\n", "rosbag2_bagfile_information: {relative: [", "a: 1\n",
                             "rosbag2_bagfile_information: {version: 5}\n"}) {
        test::writeText(folder / "metadata.yaml", text);
        expectHolds(faultOf(io::openRos2Folder, source), {"metadata.yaml"});
    }
    test::writeText(folder / "metadata.yaml",
                    "rosbag2_bagfile_information:\n  compression_mode: FILE\n"
                    "  relative_file_paths: [d_0.db3.zstd]\n");
    expectHolds(faultOf(io::openRos2Folder, source), {"convert"});
}
}  // namespace delio::bag_test
