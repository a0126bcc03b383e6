// Folders of clouds: which files, in which order, when.
#include "recordings/cloud_folder.h"

#include <mrpt/core/Clock.h>

#include <cmath>

#include "cloud_files.h"
#include "delio/mrpt/rawlog_writer.h"
#include "files/names.h"
#include "mrpt/clock.h"

namespace {
using namespace delio;
using namespace delio::cloud_test;
using test::writeText;

class CloudFolder : public testing::Test {
 protected:
    void SetUp() override { fs::create_directories(scans_); }

    /** A scan each, which tells its place in `names`. */
    void writeScans(const std::vector<std::string>& names) const {
        for (std::size_t i = 0; i < names.size(); ++i)
            writeBin(scans_ / names[i], pointsOf(static_cast<int>(i)));
    }
    /** Stamps of the scans, which are in the order of writeScans(). */
    std::vector<double> stamps() const {
        io::CloudFolder reader(scans_);
        std::vector<double> stamps;
        while (const auto scan = reader.next()) {
            EXPECT_EQ(pointsOf(*scan), pointsOf(static_cast<int>(stamps.size())));
            EXPECT_EQ(scan->index, stamps.size());
            const double epoch_s = scan->stamp_s < 5e8 ? io::kDriveEpoch_s : 0;
            EXPECT_EQ(scan->time, io::timeOf(scan->stamp_s, epoch_s));
            stamps.push_back(scan->stamp_s);
        }
        return stamps;
    }
    std::string error() const {
        return errorOf([&] {
            io::CloudFolder reader(scans_);
            while (reader.next())
                ;
        });
    }
    std::string kind() const { return io::CloudFolder(scans_).recording().kind; }

    test::TemporaryFolder folder_;
    const fs::path scans_ = folder_ / "scans";
    const std::vector<std::string> abc_{"a1.bin", "a2.bin", "a10.bin"};
};

TEST_F(CloudFolder, NaturalOrder) {
    const std::vector<std::string_view> ordered{"",
                                                "1",
                                                "2",
                                                "02a",
                                                "10",
                                                "a",
                                                "a1b",
                                                "a2",
                                                "a10",
                                                "a010b",
                                                "b1.2",
                                                "b1.10",
                                                "c99999999999999999999999",
                                                "c100000000000000000000000"};
    for (std::size_t i = 0; i < ordered.size(); ++i)
        for (std::size_t k = 0; k < ordered.size(); ++k)
            EXPECT_EQ(io::naturallyBefore(ordered[i], ordered[k]), i < k)
                << ordered[i] << " " << ordered[k];
    EXPECT_NE(io::naturallyBefore("a01", "a1"), io::naturallyBefore("a1", "a01"));
}

TEST_F(CloudFolder, NominalTimes) {
    writeScans(abc_);
    EXPECT_EQ(stamps(), (std::vector<double>{0, 0.1, 0.2}));
    io::CloudFolder reader(scans_);
    EXPECT_EQ(reader.recording().kind, "folder of .bin files, nominal times");
    EXPECT_EQ(reader.recording().scans, std::optional<std::size_t>(3));
    EXPECT_FALSE(reader.recording().motionCompensated);
    EXPECT_FALSE(reader.meta());
    EXPECT_EQ(reader.label(), "lidar");
    EXPECT_TRUE(reader.skip());
    EXPECT_EQ(reader.next()->stamp_s, 0.1);
}

TEST_F(CloudFolder, TimesFiles) {
    writeScans(abc_);
    const auto with = [&](const fs::path& file, const std::string& text) {
        writeText(file, text);
        const auto found = stamps();
        EXPECT_EQ(kind(), "folder of .bin files");
        fs::remove(file);
        return found;
    };
    using Times = std::vector<double>;
    EXPECT_EQ(with(scans_ / "times.txt", "0\n0.25\n\n1e0\n"), (Times{0, 0.25, 1}));
    EXPECT_EQ(with(folder_ / "timestamps.txt", "# s\n5\r\n6\r\n7"), (Times{5, 6, 7}));
    EXPECT_EQ(with(folder_ / "times.csv", "0\n100000\n200000\n"), (Times{0, 0.1, 0.2}));
    EXPECT_EQ(with(folder_ / "times.txt", "0\n100000000\n200000000\n"), (Times{0, 0.1, 0.2}));
    EXPECT_EQ(with(folder_ / "times.txt", "1616513421.5\n1616513422\n1616513423\n"),
              (Times{1616513421.5, 1616513422, 1616513423}));
    EXPECT_EQ(with(folder_ / "times.txt",
                   "1616513421500000000\n1616513421750000000\n1616513422000000000\n"),
              (Times{1616513421.5, 1616513421.75, 1616513422}));
    EXPECT_EQ(with(folder_ / "times.txt", "1616513421500\n1616513421750\n1616513422000\n"),
              (Times{1616513421.5, 1616513421.75, 1616513422}));
    EXPECT_EQ(with(folder_ / "timestamps.txt",
                   "2011-09-26 13:02:25.5\n2011-09-26 13:02:26\n2011-09-26 13:02:27.250000000\n"),
              (Times{1317042145.5, 1317042146, 1317042147.25}));
}

TEST_F(CloudFolder, RefusesBrokenTimesFiles) {
    writeScans(abc_);
    const auto with = [&](const std::string& text) {
        writeText(scans_ / "times.txt", text);
        return error();
    };
    const std::string file = (scans_ / "times.txt").string();
    expectError(with("0\n1\n"), {file, "2 times", "3 scans"});
    expectError(with("0\n1\n2\n3\n"), {file, "4 times"});
    expectError(with(""), {file, "0 times"});
    expectError(with("0\nnoon\n1\n"), {file, "line 2"});
    expectError(with("0\n1 7\n1\n"), {file, "line 2"});
    expectError(with("0\nnan\n1\n"), {file, "line 2"});
    expectError(with("0\n2011-09-26 13:02:25.5\n1\n"), {file, "line 2"});
    expectError(with("2011-09-26 13:02:25.5\n0\n1\n"), {file, "line 2"});
}

TEST_F(CloudFolder, TimesOfNames) {
    const auto of = [&](const std::vector<std::string>& names) {
        fs::remove_all(scans_);
        fs::create_directory(scans_);
        writeScans(names);
        return stamps();
    };
    using Times = std::vector<double>;
    EXPECT_EQ(of({"1616513421.123456.bin", "1616513421.5.bin", "1616513421.75.bin"}),
              (Times{1616513421.123456, 1616513421.5, 1616513421.75}));
    EXPECT_EQ(kind(), "folder of .bin files");
    EXPECT_EQ(of({"1616513421_250000000.pcd.bin", "1616513422_000000000.pcd.bin"}),
              (Times{1616513421.25, 1616513422}));
    EXPECT_EQ(of({"1616513421250000.bin", "1616513422000000.bin"}),
              (Times{1616513421.25, 1616513422}));
    EXPECT_EQ(of({"1616513421250000000.bin", "1616513422000000000.bin"}),
              (Times{1616513421.25, 1616513422}));
    // Not all of them, or counts.
    EXPECT_EQ(of({"1616513421250000.bin", "a.bin"}), (Times{0, 0.1}));
    EXPECT_EQ(of({"0000000000.bin", "0000000001.bin"}), (Times{0, 0.1}));
    writeBin(scans_ / "1616513421.5.bin", pointsOf(0));
    EXPECT_EQ(kind(), "folder of .bin files, nominal times");
    fs::remove_all(scans_);
    fs::create_directory(scans_);
    writeScans({"1616513421.5.bin", "1616513421.50.bin"});
    EXPECT_EQ(stamps(), (Times{1616513421.5, 1616513421.5}));
}

// Whoever opens the folder by openScans() gets scans whose stamps rise.
TEST_F(CloudFolder, TimesThatDoNotRiseAreNoFault) {
    writeScans(abc_);
    for (const auto& times : {std::vector<double>{0, 1, 1}, std::vector<double>{0, 2, 1}}) {
        std::string text;
        for (const double time : times) text += std::to_string(time) + "\n";
        writeText(scans_ / "times.txt", text);
        EXPECT_EQ(stamps(), times);
        const auto reader = io::openScans(scans_.string());
        std::vector<double> given;
        while (const auto scan = reader->next()) given.push_back(scan->stamp_s);
        EXPECT_EQ(given,
                  times[1] == 2 ? (std::vector<double>{0, 1, 2}) : (std::vector<double>{0, 1}));
        EXPECT_EQ(reader->recording().findings.size(), 1U);
    }
}

// The first scan's times are those of another unit than the others', and one is of no time at all.
TEST_F(CloudFolder, SeveralScansTellTheUnitOfPointTimes) {
    for (int scan = 0; scan < 6; ++scan) {
        std::string text = "x y z t\n";
        for (int i = 0; i < 50; ++i) {
            const double time_ns = scan == 3 && i == 4 ? 7e12 : (scan == 0 ? 4e9 : 1e8) * i / 49;
            text += "5 " + std::to_string(i) + " 1 " + std::to_string(time_ns) + "\n";
        }
        writeText(scans_ / (std::to_string(scan) + ".txt"), text);
    }
    const auto reader = io::openScans(scans_.string());
    EXPECT_TRUE(reader->recording().pointTimes);
    for (int scan = 0; scan < 6; ++scan) {
        const auto times_s = reader->next()->times_s;
        ASSERT_EQ(times_s.size(), scan == 0 ? 0U : 50U) << scan;
        if (scan == 0) continue;
        EXPECT_NEAR(times_s.back(), 0.1, 1e-6) << scan;
        EXPECT_EQ(std::isnan(times_s[4]), scan == 3) << scan;
    }
    const auto findings = reader->recording().findings;
    ASSERT_EQ(findings.size(), 2U);
    EXPECT_NE(findings[0].find("1 scan (first: scan 0)"), std::string::npos) << findings[0];
    EXPECT_NE(findings[1].find("1 point of 1 scan (first: scan 3)"), std::string::npos);
}

TEST_F(CloudFolder, EmptyFirstScansTellNothingOfTimes) {
    const std::string head = "FIELDS x y z time\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS ";
    for (int scan = 0; scan < 6; ++scan) {
        std::string text = head + (scan < 4 ? "0" : "20") + "\nDATA ascii\n";
        for (int i = 0; scan >= 4 && i < 20; ++i)
            text += "5 6 7 " + std::to_string(0.005 * i) + "\n";
        writeText(scans_ / (std::to_string(scan) + ".pcd"), text);
    }
    const auto of = [&] { return describe(io::openScans(scans_.string())->recording()); };
    EXPECT_NE(of().find(", points with times"), std::string::npos) << of();
    for (int scan = 4; scan < 6; ++scan) fs::remove(scans_ / (std::to_string(scan) + ".pcd"));
    EXPECT_NE(of().find(", first scans empty"), std::string::npos) << of();
}

TEST_F(CloudFolder, FilesOfOneKindOnly) {
    expectError(error(), {scans_.string(), "no scans"});
    EXPECT_EQ(error().find("KITTI"), std::string::npos);
    fs::create_directories(scans_ / "sequences/04/velodyne");  // the root of KITTI's data
    fs::create_directories(scans_ / "sequences/05/velodyne");
    fs::create_directories(scans_ / "poses");
    expectError(error(), {"no scans", "KITTI", (scans_ / "sequences/04").string()});
    expectError(errorOf([&] { io::CloudFolder{folder_ / "none"}; }), {"none", "not a folder"});
    writeScans(abc_);
    for (const char* name : {"README.txt", "calib.txt", "poses.txt", "a.jpg", "b", ".c.pcd"})
        writeText(scans_ / name, "hello\n");
    fs::create_directory(scans_ / "d.pcd");
    EXPECT_EQ(stamps().size(), 3U);
    writeText(scans_ / "a.pcd", "");
    writeText(scans_ / "b.CSV", "");
    writeText(scans_ / "c.csv", "");
    expectError(error(), {scans_.string(), "3 .bin", "1 .pcd", "2 .csv"});
}

TEST_F(CloudFolder, EveryKind) {
    const auto only = [&](const std::string& name, const std::string& text) {
        fs::remove_all(scans_);
        fs::create_directory(scans_);
        writeText(scans_ / name, text);
        io::CloudFolder reader(scans_);
        const auto scan = reader.next();
        EXPECT_TRUE(scan);
        EXPECT_FALSE(reader.next());
        EXPECT_EQ(pointsOf(*scan), (std::vector<Xyzi>{{1, 2, 3, 0.5F}}));
    };
    only("a.PCD",
         "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 1\nDATA ascii\n1 2 3 .5\n");
    only("a.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
         "float z\nproperty float intensity\nend_header\n1 2 3 .5\n");
    only("a.bin", raw(Xyzi{1, 2, 3, 0.5F}));
    only("a.txt", "1 2 3 .5\n");
    only("a.csv", "x,y,z,intensity\n1,2,3,0.5\n");
}

// 20 points of 4 numbers are as many bytes as 16 of 5.
TEST_F(CloudFolder, BinWithAndWithoutRings) {
    writeBin(scans_ / "0.bin", pointsOf(0, 20));
    writeBin(scans_ / "1.bin", pointsOf(1, 7));
    io::CloudFolder kitti(scans_);
    EXPECT_EQ(pointsOf(*kitti.next()), pointsOf(0, 20));
    EXPECT_EQ(pointsOf(*kitti.next()), pointsOf(1, 7));

    std::string bytes;
    for (int i = 0; i < 16; ++i) bytes += raw(Xyzi{0.5F, 1, 2, 3}, static_cast<float>(i));
    writeText(scans_ / "0.bin", bytes);
    writeText(scans_ / "1.bin", bytes.substr(0, 100));
    io::CloudFolder nuScenes(scans_);
    const auto first = nuScenes.next(), second = nuScenes.next();
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->rings[15], 15);
    EXPECT_EQ(pointsOf(*second), std::vector<Xyzi>(5, {0.5F, 1, 2, 3}));

    writeText(scans_ / "1.bin", bytes.substr(0, 64));
    expectError(error(), {(scans_ / "1.bin").string(), "multiple of 20"});
    for (const char* text : {"", "123456789012345", "123456789012345678901234"}) {
        writeText(scans_ / "0.bin", text);
        expectError(error(), {(scans_ / "0.bin").string()});
    }
}

// 16 points of 36 bytes (x y z intensity, then whole numbers) are as many bytes as 36 of 16.
TEST_F(CloudFolder, BinOfAnotherLayoutIsRefused) {
    std::string bytes;
    for (std::uint32_t i = 0; i < 16; ++i)
        bytes += raw(Xyzi{0.5F, 1, 2, 30}) + raw(1U + i, 2U + i, 512 * i, 3U + i, 7U);
    ASSERT_EQ(bytes.size(), 576U);
    writeText(scans_ / "0.bin", bytes);
    expectError(error(), {(scans_ / "0.bin").string(), "36 bytes", ".pcd", "--sensor-label"});
    fs::create_directories(folder_ / "seq" / "velodyne");
    writeText(folder_ / "seq" / "velodyne" / "000000.bin", bytes);
    const auto kitti = io::openKittiFolder({folder_ / "seq", "", "", ""});
    expectError(errorOf([&] { kitti->next(); }), {"000000.bin", "36 bytes"});
}

// A KITTI folder has KITTI's layout.
TEST_F(CloudFolder, KnownLayoutInAKittiFolderIsRefused) {
    std::string bytes;
    for (int i = 0; i < 64; ++i)
        bytes +=
            raw(Xyzi{0.5F, 1, 2, 30}, static_cast<float>(i % 8), 1e-3F * static_cast<float>(i));
    fs::create_directories(folder_ / "seq" / "velodyne");
    writeText(folder_ / "seq" / "velodyne" / "000000.bin", bytes);
    const auto kitti = io::openKittiFolder({folder_ / "seq", "", "", ""});
    expectError(errorOf([&] { kitti->next(); }), {"000000.bin", "24 bytes", "layout boreas"});
}

TEST_F(CloudFolder, EndsAtAFault) {
    writeText(scans_ / "0.txt", "1 2 3\n");
    writeText(scans_ / "1.txt", "1 2 x\n");
    writeText(scans_ / "2.txt", "1 2 3\n");
    io::CloudFolder reader(scans_);
    EXPECT_TRUE(reader.next());
    expectError(errorOf([&] { reader.next(); }), {(scans_ / "1.txt").string(), "line 1"});
    EXPECT_FALSE(reader.next());
}
}  // namespace
