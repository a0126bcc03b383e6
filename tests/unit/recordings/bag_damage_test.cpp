#include <cstring>
#include <random>

#include "bag_files.h"
#include "memory_limit.h"

namespace delio::bag_test {
namespace {
/** The index of a whole bag is at its end: these scans come out of its first `bytes` bytes. */
Outcome readCut(const Container& container, const std::string& whole, std::size_t bytes,
                const std::filesystem::path& file) {
    test::writeText(file, whole.substr(0, bytes));
    return readAll(container.open, {file.string(), "", "", ""});
}

void replaceNumber(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t size) {
    std::memcpy(bytes.data() + at, &value, size);
}
}  // namespace

TEST(BagDamage, CutOffAnywhereGivesWhatWasBefore) {
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(6, container.kind));
        const std::string whole = test::readText(file);
        const bool neverIndexed = std::string(container.name) == "bag, no index";
        std::size_t before = 0;
        for (std::size_t bytes = 0; bytes < whole.size(); bytes += 37) {
            const Outcome outcome = readCut(container, whole, bytes, file);
            EXPECT_GE(outcome.scans, before) << "cut at byte " << bytes;
            before = outcome.scans;
            EXPECT_TRUE(neverIndexed || !outcome.fault.empty()) << "cut at byte " << bytes;
        }
        const bool database = std::string(container.name) == "db3";
        EXPECT_TRUE(database || before >= 5) << before;
    }
}

TEST(BagDamage, FlippedBytesNeverCrash) {
    std::mt19937 random(3);
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(4, container.kind));
        const std::string whole = test::readText(file);
        for (int round = 0; round < 150; ++round) {
            std::string bytes = whole;
            for (int i = 0; i < 3; ++i)
                bytes[random() % bytes.size()] = static_cast<char>(random() & 0xffU);
            test::writeText(file, bytes);
            try {
                const auto reader = container.open({file.string(), "", "", ""});
                while (reader->next()) continue;
            } catch (const Error& e) {
                EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            }
        }
    }
}

// Every length and every offset, and whatever else lies there.
TEST(BagDamage, NumbersThatWrapAroundNeitherCrashNorKeepReading) {
    for (const Container& container : containers()) {
        SCOPED_TRACE(container.name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(2, container.kind, 3));
        const std::string whole = test::readText(file);
        const std::size_t stride = whole.size() / 400 + 1;
        for (std::size_t at = 0; at + 8 <= whole.size(); at += stride)
            for (const std::uint64_t number : {~std::uint64_t{0}, std::uint64_t(-9)}) {
                std::string bytes = whole;
                replaceNumber(bytes, at, number, 8);
                test::writeText(file, bytes);
                try {
                    const auto reader = container.open({file.string(), "", "", ""});
                    while (reader->next()) continue;
                } catch (const Error& e) {
                    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
                }
            }
    }
}

TEST(BagDamage, ARecordOfTheSummaryEndsWhereItBegins) {
    const test::TemporaryFolder folder;
    const auto mcap = folder / "d.mcap";
    const std::string magic = "\x89MCAP0\r\n";
    std::string bytes = magic + '\x0d' + std::string(8, '\xff') + '\2' + std::string(28, '\0');
    replaceNumber(bytes, 9, std::uint64_t(-9), 8);
    replaceNumber(bytes, 18, 20, 8);  // the footer's length, and where the summary begins
    replaceNumber(bytes, 26, 8, 8);
    test::writeText(mcap, bytes + magic);
    expectHolds(faultOf(io::openMcap, {mcap.string(), "", "", ""}), {"is cut off", "its 54 bytes"});
}

TEST(BagDamage, ChunksOfGigabytesAreRefusedBeforeTheyAreUnpacked) {
    const test::TemporaryFolder folder;
    const auto bag = folder / "d.bag", mcap = folder / "d.mcap";
    writeRos1Bag(bag, drive(4), "lz4");
    std::string bytes = test::readText(bag);
    replaceNumber(bytes, bytes.find("size=", bytes.find("compression=lz4")) + 5, 0x40000001, 4);
    test::writeText(bag, bytes);
    expectHolds(faultOf(io::openRos1Bag, {bag.string(), "", "", ""}), {"1073741825", "claims"});
    writeMcap(mcap, drive(4, Kind::kCdr), "zstd");
    bytes = test::readText(mcap);
    replaceNumber(bytes, bytes.find("zstd") - 16, 0x40000001, 8);
    test::writeText(mcap, bytes);
    expectHolds(faultOf(io::openMcap, {mcap.string(), "", "", ""}), {"1073741825", "claims"});
}

TEST(BagDamage, LyingSizesTakeNoMemory) {
    const test::TemporaryFolder folder;
    const auto bag = folder / "d.bag", mcap = folder / "d.mcap";
    writeRos1Bag(bag, drive(4), "lz4");
    std::string bytes = test::readText(bag);
    const std::size_t chunk = bytes.find("compression=lz4");
    const test::MemoryLimit limit(500);
    // What it unpacks to.
    const std::size_t size = bytes.find("size=", chunk);
    replaceNumber(bytes, size + 5, 0xfffffff0, 4);
    test::writeText(bag, bytes);
    expectHolds(faultOf(io::openRos1Bag, {bag.string(), "", "", ""}), {"damaged"});
    // The length of its record.
    replaceNumber(bytes, size + 9, 0xfffffff0, 4);
    test::writeText(bag, bytes);
    expectHolds(faultOf(io::openRos1Bag, {bag.string(), "", "", ""}), {"cut off"});
    // The header's length of the first record.
    replaceNumber(bytes, 13, 0xfffffff0, 4);
    test::writeText(bag, bytes);
    EXPECT_NE(faultOf(io::openRos1Bag, {bag.string(), "", "", ""}), "");

    for (const std::string compression : {"", "zstd"}) {
        writeMcap(mcap, drive(4, Kind::kCdr), compression);
        bytes = test::readText(mcap);
        const std::size_t first = 8 + 9 + 16;  // magic and the header's record
        ASSERT_EQ(bytes[first], 6);
        for (const std::size_t at :
             {first + 1, first + 9 + 16, first + 9 + 16 + 16 + compression.size()}) {
            std::string lie = bytes;
            replaceNumber(lie, at, 10000000000, 8);
            test::writeText(mcap, lie);
            EXPECT_NE(faultOf(io::openMcap, {mcap.string(), "", "", ""}), "") << at;
        }
    }
}

TEST(BagDamage, FieldLongerThanItsHeader) {
    const test::TemporaryFolder folder;
    const auto bag = folder / "d.bag";
    writeRos1Bag(bag, drive(4));
    std::string bytes = test::readText(bag);
    const std::size_t field = bytes.find("compression=none");
    replaceNumber(bytes, field - 4, 5000, 4);
    test::writeText(bag, bytes);
    const Outcome outcome = readAll(io::openRos1Bag, {bag.string(), "", "", ""});
    expectHolds(outcome.fault, {"longer than its record's header", "after 0 scans"});
}

TEST(BagDamage, DamagedCompressionIsTold) {
    for (const Container& container : containers()) {
        const std::string name = container.name;
        if (name.find("z") == std::string::npos) continue;
        SCOPED_TRACE(name);
        const test::TemporaryFolder folder;
        const auto file = folder / container.file;
        container.write(file, drive(8, container.kind, 200));
        std::string bytes = test::readText(file);
        for (std::size_t i = 0; i < 200; ++i) bytes[bytes.size() / 2 + i] = static_cast<char>(i);
        test::writeText(file, bytes);
        const Outcome outcome = readAll(container.open, {file.string(), "", "", ""});
        EXPECT_NE(outcome.fault, "");
        EXPECT_LT(outcome.scans, 8U);
    }
}

TEST(BagDamage, ChecksumOfAChunkIsHeld) {
    const test::TemporaryFolder folder;
    const auto mcap = folder / "d.mcap";
    writeMcap(mcap, drive(4, Kind::kCdr));
    std::string bytes = test::readText(mcap);
    const std::size_t text = bytes.rfind("on we go");
    bytes[text] = 'O';
    test::writeText(mcap, bytes);
    const Outcome outcome = readAll(io::openMcap, {mcap.string(), "", "", ""});
    expectHolds(outcome.fault, {"checksum", "after 3 scans"});
}

TEST(BagDamage, DatabasesThatComputeAreRefused) {
    for (const char* const sql :
         {"ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m",
          "ALTER TABLE topics ADD COLUMN more AS (zeroblob(9))", "DROP TABLE topics"}) {
        const test::TemporaryFolder folder;
        test::writeDatabase(folder / "d.db3", drive(2, Kind::kCdr));
        test::changeDatabase(folder / "d.db3", sql);
        const auto fault =
            readAll(io::openRos2Database, {(folder / "d.db3").string(), "", "", ""}).fault;
        EXPECT_NE(fault.find("not a ROS 2 database"), std::string::npos) << sql << ": " << fault;
    }
}

TEST(BagDamage, RecorderThatWasEndedLeavesItsLastChunkOpen) {
    const test::TemporaryFolder folder;
    const auto bag = folder / "d.bag.active";
    writeRos1Bag(bag, drive(4), "none", Index::kNever, 100);
    std::string bytes = test::readText(bag);
    const std::size_t size = bytes.find("size=");
    replaceNumber(bytes, size + 5, 0, 4);
    replaceNumber(bytes, size + 9, 0, 4);
    test::writeText(bag, bytes);
    EXPECT_EQ(readAll(io::openRos1Bag, {bag.string(), "", "", ""}).scans, 4U);
}
}  // namespace delio::bag_test
