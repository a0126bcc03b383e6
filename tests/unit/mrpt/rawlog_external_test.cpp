// Clouds outside of their rawlog, and what lies beside them.
#include <gtest/gtest.h>
#include <mrpt/io/lazy_load_path.h>

#include <cstdint>
#include <cstring>
#include <limits>

#include "rawlog_files.h"

namespace {
using namespace delio;
using namespace delio::rawlog_test;

TEST(RawlogReader, ExternalCloudsAndWhereTheyAreLookedFor) {
    const test::TemporaryFolder folder;
    const float xyzi[8] = {1, 2, 3, 0.5F, 4, 5, 6, 0.25F};
    const auto writeBin = [&](const std::string& path, std::size_t bytes) {
        std::filesystem::create_directories(std::filesystem::path(path).parent_path());
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char*>(xyzi), static_cast<std::streamsize>(bytes));
    };
    const auto external = [](const std::string& file) {
        auto observation = CObservationPointCloud::Create();
        observation->sensorLabel = "lidar";
        observation->setAsExternalStorage(
            file, CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
        return observation;
    };
    writeRawlog(folder / "a.rawlog", {external("0.bin"), external("1.bin")});

    std::size_t scans = 0;
    io::RawlogReader missing(folder / "a.rawlog");
    const std::string fault = faultOf(missing, scans);
    EXPECT_NE(fault.find("a_Images"), std::string::npos) << fault;
    EXPECT_NE(fault.find("/Images"), std::string::npos) << fault;

    for (const std::string where : {"a_Images", "Images", "elsewhere"}) {
        writeBin(folder / (where + "/0.bin"), 32);
        writeBin(folder / (where + "/1.bin"), 0);
        io::RawlogReader reader(
            folder / "a.rawlog", "",
            where == "elsewhere" ? (folder / "elsewhere").string() : std::string());
        const auto scan = reader.next();
        ASSERT_TRUE(scan);
        ASSERT_EQ(scan->points->size(), 2U);
        EXPECT_EQ(scan->points->getPointsBufferRef_z()[1], 6);
        EXPECT_EQ(reader.next()->points->size(), 0U);
        if (where == "elsewhere") break;
        std::filesystem::remove_all(folder / where);
    }
    writeBin(folder / "a_Images/0.bin", 30);
    io::RawlogReader cut(folder / "a.rawlog");
    EXPECT_NE(faultOf(cut, scans).find("multiple of 16"), std::string::npos);
}

// 1F 8B begins a gzip file, and a float of -0.216, too.
TEST(RawlogReader, ExternalCloudsThatBeginLikeGzip) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "a_Images");
    const std::uint32_t bits = 0xBE5D8B1F;
    float x = 0;
    std::memcpy(&x, &bits, sizeof(x));
    writeValues<float>(folder / "a_Images/0.bin", {x, 2, 3, 0.5F, 4, 5, 6, 0.25F});
    auto external = cloudObservation(0);
    external->setAsExternalStorage("0.bin",
                                   CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    writeRawlog(folder / "a.rawlog", {external});
    io::RawlogReader reader(folder / "a.rawlog");
    const auto scan = reader.next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 2U);
    EXPECT_EQ(scan->points->getPointsBufferRef_x()[0], x);
    const auto* points = dynamic_cast<const mrpt::maps::CPointsMapXYZI*>(scan->points.get());
    ASSERT_TRUE(points);
    EXPECT_EQ(points->getPointIntensity_fast(1), 0.25F);
}

TEST(RawlogReader, RingsAndTimesOfPointsLieBesideTheExternalFiles) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "a_Images");
    auto external = cloudObservation(0);
    writeValues<float>(folder / "a_Images/first.bin", {1, 2, 3, 0, 4, 5, 6, 0});
    external->setAsExternalStorage("first.bin",
                                   CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    writeValues<std::uint16_t>(folder / "a_Images/first.ring", {7, 300});
    writeValues<float>(folder / "a_Images/first.time", {-0.05F, 0.03F});
    // An embedded scan has no file of its own: its extras are named by its number.
    writeValues<float>(folder / "a_Images/000001.time", std::vector<float>(50, 0.01F));
    writeRawlog(folder / "a.rawlog", {external, cloudObservation(1), cloudObservation(2)});
    io::RawlogReader reader(folder / "a.rawlog");
    const auto first = reader.next(), second = reader.next(), third = reader.next();
    ASSERT_TRUE(third);
    EXPECT_EQ(first->rings, (std::vector<std::uint16_t>{7, 300}));
    EXPECT_EQ(first->times_s, (std::vector<float>{-0.05F, 0.03F}));
    EXPECT_EQ(second->times_s, std::vector<float>(50, 0.01F));
    EXPECT_TRUE(second->rings.empty());
    EXPECT_TRUE(third->times_s.empty());
}

TEST(RawlogReader, ExtrasThatDoNotFitTheirScanAreNamed) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "a_Images");
    writeValues<float>(folder / "a_Images/000001.time", {0, 0, 0});
    writeRawlog(folder / "a.rawlog", {cloudObservation(0), cloudObservation(1)});
    io::RawlogReader reader(folder / "a.rawlog");
    std::size_t scans = 0;
    const auto fault = faultOf(reader, scans);
    EXPECT_EQ(scans, 1U);
    EXPECT_NE(fault.find("000001.time"), std::string::npos) << fault;
    EXPECT_NE(fault.find("12 bytes"), std::string::npos) << fault;
    EXPECT_NE(fault.find("50 points"), std::string::npos) << fault;
}

TEST(RawlogReader, TimesThatCannotBeAreNamed) {
    for (const float bad : {std::numeric_limits<float>::infinity(), 1e9F, -2.0F}) {
        const test::TemporaryFolder folder;
        std::filesystem::create_directory(folder / "a_Images");
        std::vector<float> times_s(50, 0.01F);
        times_s[20] = bad;
        writeValues(folder / "a_Images/000001.time", times_s);
        writeRawlog(folder / "a.rawlog", {cloudObservation(0), cloudObservation(1)});
        io::RawlogReader reader(folder / "a.rawlog");
        std::size_t scans = 0;
        const auto fault = faultOf(reader, scans);
        EXPECT_EQ(scans, 1U) << bad;
        EXPECT_NE(fault.find("000001.time"), std::string::npos) << fault;
    }
}

// As scans2rawlog writes a point whose time is not known.
TEST(RawlogReader, APointWithoutATime) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "a_Images");
    std::vector<float> times_s(50, 0.01F);
    times_s[20] = std::numeric_limits<float>::quiet_NaN();
    writeValues(folder / "a_Images/000000.time", times_s);
    writeRawlog(folder / "a.rawlog", {cloudObservation(0)});
    const auto scan = io::RawlogReader(folder / "a.rawlog").next();
    ASSERT_EQ(scan->times_s.size(), 50U);
    EXPECT_TRUE(std::isnan(scan->times_s[20]));
    EXPECT_EQ(scan->times_s[21], 0.01F);
}

TEST(RawlogReader, ExternalCloudsThatMrptSerialised) {
    const test::TemporaryFolder folder;
    const auto observation = CObservationPointCloud::Create();
    observation->sensorLabel = "lidar";
    observation->setAsExternalStorage(
        "0.gz", CObservationPointCloud::ExternalStorageFormat::MRPT_Serialization);
    writeRawlog(folder / "a.rawlog", {observation});
    std::filesystem::create_directory(folder / "a_Images");
    const std::string file = folder / "a_Images/0.gz";
    writeRawlog<mrpt::io::CFileGZOutputStream>(file, {cloudObservation(3)->pointcloud});
    const auto scan = io::RawlogReader(folder / "a.rawlog").next();
    ASSERT_TRUE(scan);
    ASSERT_EQ(scan->points->size(), 50U);
    EXPECT_EQ(scan->points->getPointsBufferRef_y()[49], 49);

    const std::string whole = test::readText(file);
    for (std::size_t i = 10; i < whole.size(); i += 7) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
        for (const auto& bytes : {damaged, whole.substr(0, i)}) {
            test::writeText(file, bytes);
            io::RawlogReader reader(folder / "a.rawlog");
            std::size_t scans = 0;
            EXPECT_NE(faultOf(reader, scans).find("0.gz"), std::string::npos) << "byte " << i;
        }
    }
}

/** KITTI's floats, gzipped as CPointsMap::saveToKittiVelodyneFile() does. */
TEST(RawlogReader, CompressedFloatsAreCountedAsTheyUnpack) {
    const test::TemporaryFolder folder;
    const auto observation = CObservationPointCloud::Create();
    observation->setAsExternalStorage("0.bin",
                                      CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    writeRawlog(folder / "a.rawlog", {observation});
    std::filesystem::create_directory(folder / "a_Images");
    const std::vector<float> xyzi(8, 1.0F);
    for (const std::size_t bytes : {32U, 31U}) {
        mrpt::io::CFileGZOutputStream(folder / "a_Images/0.bin").Write(xyzi.data(), bytes);
        io::RawlogReader reader(folder / "a.rawlog");
        std::size_t scans = 0;
        const std::string fault = faultOf(reader, scans);
        EXPECT_EQ(scans, bytes / 32);
        EXPECT_EQ(fault.find("multiple of 16") != std::string::npos, bytes == 31) << fault;
    }
}

/** Each looks in its own folder, whatever another one read last. */
TEST(RawlogReader, SeveralReadersDoNotMeet) {
    const test::TemporaryFolder folder;
    const std::vector<std::string> drives = {"a", "b"};
    std::vector<std::unique_ptr<io::ScanReader>> readers;
    for (std::size_t drive = 0; drive < 2; ++drive) {
        const std::string images = drives[drive] + "_Images";
        std::filesystem::create_directory(folder / images);
        std::vector<mrpt::serialization::CSerializable::Ptr> objects;
        for (const std::string file : {"0.bin", "1.bin"}) {
            const auto value = static_cast<float>(10 * drive + objects.size());
            writeValues<float>(folder / (images + "/" + file), {value, 0, 0, 0});
            const auto observation = CObservationPointCloud::Create();
            observation->setAsExternalStorage(
                file, CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
            objects.push_back(observation);
        }
        const std::string rawlog = folder / (drives[drive] + ".rawlog");
        writeRawlog(rawlog, objects);
        readers.push_back(io::openScans(rawlog));
    }
    const std::string base = mrpt::io::getLazyLoadPathBase();
    for (std::size_t scan = 0; scan < 2; ++scan)
        for (std::size_t drive = 0; drive < 2; ++drive) {
            const auto read = readers[drive]->next();
            ASSERT_TRUE(read);
            ASSERT_EQ(read->points->size(), 1U);
            EXPECT_EQ(read->points->getPointsBufferRef_x()[0],
                      static_cast<float>(10 * drive + scan));
        }
    EXPECT_EQ(mrpt::io::getLazyLoadPathBase(), base);
}

/** From the folder that the program runs in, too. */
TEST(RawlogReader, RelativePathsOfRawlogsAndImages) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directory(folder / "elsewhere");
    writeValues<float>(folder / "elsewhere/0.bin", {1, 2, 3, 0});
    const auto observation = CObservationPointCloud::Create();
    observation->setAsExternalStorage("0.bin",
                                      CObservationPointCloud::ExternalStorageFormat::KittiBinFile);
    writeRawlog(folder / "a.rawlog", {observation});
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    std::optional<Scan> scan;
    EXPECT_NO_THROW(scan = io::openScans("a.rawlog", "", "elsewhere")->next());
    std::filesystem::current_path(before);
    ASSERT_TRUE(scan);
    EXPECT_EQ(scan->points->size(), 1U);
}
}  // namespace
