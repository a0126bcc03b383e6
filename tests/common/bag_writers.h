#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/** Bags as recorders write them, for tests. */
namespace delio::test {
using BagBytes = std::string;

/** Writes the fields of a message as ROS 1 or as CDR. */
class WireWriter {
 public:
    enum class Kind { kRos1, kCdr, kCdrBigEndian };
    explicit WireWriter(Kind kind);

    template <typename Number>
    WireWriter& number(Number value) {
        return raw(static_cast<std::uint64_t>(value), sizeof(Number));
    }
    WireWriter& text(const std::string& value);
    /** Bytes alone, and behind their length. */
    WireWriter& bytes(const BagBytes& value);
    WireWriter& byteArray(const BagBytes& value);
    /** std_msgs/Header. */
    WireWriter& header(double stamp_s, const std::string& frame = "velodyne");
    WireWriter& time(double seconds);
    /** A number of 8 bytes. */
    WireWriter& real(double value);
    const BagBytes& message() const { return bytes_; }

 private:
    WireWriter& raw(std::uint64_t value, std::size_t size);

    Kind kind_;
    BagBytes bytes_;
};

/** A sensor_msgs/PointCloud2 of x, y, z, intensity (float32), ring (uint16) and time (float32). */
struct CloudSpec {
    int scan = 0;  //!< what the points tell
    double stamp_s = 0;
    std::string frame = "velodyne";
    std::uint32_t rows = 1, columns = 20;
    std::uint32_t padding = 0;  //!< bytes behind each row
    bool withX = true;
    bool bigEndian = false;  //!< the points' numbers
    /** x, y, z and intensity of each point, rows x columns of them, instead of what tells the scan
     *  and without rings and times. */
    const std::vector<float>* xyzi = nullptr;
};
/** A tf2_msgs/TFMessage with the poses of frames in "base", which are turned by 90 deg about z. */
BagBytes transformsMessage(const std::vector<std::pair<std::string, Eigen::Vector3d>>& frames,
                           WireWriter::Kind kind);

BagBytes cloudMessage(const CloudSpec& spec, WireWriter::Kind kind = WireWriter::Kind::kRos1);

struct BagTopic {
    std::string name, type;
};
struct BagMessage {
    std::size_t topic = 0;  //!< which of the topics
    double log_s = 0;
    BagBytes bytes;
};
/** What lies in a bag. */
struct BagContents {
    std::vector<BagTopic> topics;
    std::vector<BagMessage> messages;
    std::string encoding = "ros1";  //!< of MCAP's channels
};

enum class Index { kWritten, kNever };
/** `compression`: none, bz2 or lz4; a chunk holds `perChunk` messages. */
void writeRos1Bag(const std::filesystem::path& file, const BagContents& contents,
                  const std::string& compression = "none", Index index = Index::kWritten,
                  std::size_t perChunk = 2);
/** `compression`: "", lz4 or zstd; chunks of `perChunk` messages, 0: none. */
void writeMcap(const std::filesystem::path& file, const BagContents& contents,
               const std::string& compression = "", Index index = Index::kWritten,
               std::size_t perChunk = 2);
void writeDatabase(const std::filesystem::path& file, const BagContents& contents);
/** Runs `sql` in a database that is there. */
void changeDatabase(const std::filesystem::path& file, const std::string& sql);
/** metadata.yaml; the files themselves are the caller's. */
void writeMetadata(const std::filesystem::path& folder, const BagContents& contents,
                   const std::vector<std::string>& files);
}  // namespace delio::test
