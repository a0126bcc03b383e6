// Files beyond 4 GB, with holes for most of it: no disk is filled.
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservationComment.h>

#include "bag_files.h"
#include "rawlog_files.h"

namespace delio {
namespace {
constexpr std::uint64_t kLarge = 4'400'000'000;

/** `bytes` and then nothing for `hole` bytes, at the end of the file. */
void addWithHole(const std::filesystem::path& file, const std::string& bytes, std::uint64_t hole) {
    std::ofstream(file, std::ios::binary | std::ios::app) << bytes;
    std::filesystem::resize_file(file, std::filesystem::file_size(file) + hole);
}

std::string bytesOf(const mrpt::serialization::CSerializable& object) {
    mrpt::io::CMemoryStream out;
    mrpt::serialization::archiveFrom(out) << object;
    return {static_cast<const char*>(out.getRawBufferData()), out.getTotalBytesCount()};
}
}  // namespace

TEST(LargeFiles, RawlogHasScansBehindFourGigabytes) {
    const test::TemporaryFolder folder;
    const std::string path = (folder / "d.rawlog").string();
    addWithHole(path, bytesOf(*rawlog_test::cloudObservation(0)), 0);
    // A text of zeros that are not there: only the object's end has to be written.
    mrpt::obs::CObservationComment comment;
    constexpr std::uint32_t kHole = 10'000'000;
    comment.text = "hole";
    const std::string whole = bytesOf(comment);
    const std::size_t text = whole.find(comment.text);
    std::string head = whole.substr(0, text);
    std::memcpy(&head[text - sizeof(kHole)], &kHole, sizeof(kHole));
    const std::string tail = whole.substr(text + comment.text.size());
    while (std::filesystem::file_size(path) < kLarge) {
        addWithHole(path, head, kHole);
        addWithHole(path, tail, 0);
    }
    addWithHole(path, bytesOf(*rawlog_test::cloudObservation(1)), 0);

    io::RawlogReader reader(path);
    ASSERT_TRUE(reader.next());
    const auto last = reader.next();
    ASSERT_TRUE(last);
    EXPECT_EQ(last->index, 1U);
    EXPECT_EQ(last->points->getPointsBufferRef_x()[0], 1);
    EXPECT_FALSE(reader.next());
}

TEST(LargeFiles, BagHasItsIndexBehindFourGigabytes) {
    const test::TemporaryFolder folder;
    const auto path = folder / "d.bag";
    writeRos1Bag(path, bag_test::drive(3));
    const std::string whole = test::readText(path);
    const std::size_t place = whole.find("index_pos=") + std::string("index_pos=").size();
    std::uint64_t index = 0;
    std::memcpy(&index, &whole[place], sizeof(index));
    // Two records of a kind that is passed over, before the first chunk.
    const std::size_t start = 13 + 4096 + 8;
    constexpr std::uint32_t kHole = kLarge / 2;
    std::string passedOver("\x08\0\0\0\x04\0\0\0op=\x04", 12);
    passedOver += std::string(reinterpret_cast<const char*>(&kHole), sizeof(kHole));
    index += 2 * (passedOver.size() + kHole);
    std::string begin = whole.substr(0, start);
    std::memcpy(&begin[place], &index, sizeof(index));
    test::writeText(path, begin);
    addWithHole(path, passedOver, kHole);
    addWithHole(path, passedOver, kHole);
    addWithHole(path, whole.substr(start), 0);

    const auto reader = io::openRos1Bag({path.string(), "", "", ""});
    std::size_t scans = 0;
    while (const auto scan = reader->next())
        EXPECT_EQ(scan->index, scans++) << "scan after " << kLarge;
    EXPECT_EQ(scans, 3U);
}
}  // namespace delio
