#include "bag_writers.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <cmath>
#include <fstream>
#include <map>
#include <stdexcept>

namespace delio::test {
namespace {
template <typename Number>
BagBytes little(Number value) {
    BagBytes bytes;
    for (std::size_t i = 0; i < sizeof(Number); ++i)
        bytes += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xffU);
    return bytes;
}

BagBytes sized(const BagBytes& bytes) {
    return little(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

std::uint64_t nanoseconds(double seconds) {
    return static_cast<std::uint64_t>(std::llround(seconds * 1e6)) * 1000;
}

BagBytes pack(const std::string& compression, const BagBytes& bytes) {
    if (compression.empty() || compression == "none") return bytes;
    BagBytes packed;
    if (compression == "bz2") {
        auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 50 + 700);
        packed.resize(size);
        BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(bytes.data()),
                                 static_cast<unsigned>(bytes.size()), 9, 0, 0);
        packed.resize(size);
    } else if (compression == "lz4") {
        packed.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
        packed.resize(
            LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
    } else {
        packed.resize(ZSTD_compressBound(bytes.size()));
        packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
    }
    return packed;
}

using Fields = std::vector<std::pair<std::string, BagBytes>>;

BagBytes fieldsOf(const Fields& fields) {
    BagBytes bytes;
    for (const auto& [name, value] : fields) bytes += sized(name + "=" + value);
    return bytes;
}

BagBytes record(const Fields& fields, const BagBytes& data) {
    return sized(fieldsOf(fields)) + sized(data);
}

BagBytes op(int value) { return BagBytes(1, static_cast<char>(value)); }

BagBytes bagTime(double seconds) {
    const std::uint64_t ns = nanoseconds(seconds), second = 1000000000;
    return little(static_cast<std::uint32_t>(ns / second)) +
           little(static_cast<std::uint32_t>(ns % second));
}

BagBytes connection(const BagContents& contents, std::size_t i) {
    const auto& [name, type] = contents.topics[i];
    return record({{"op", op(7)}, {"topic", name}, {"conn", little(static_cast<std::uint32_t>(i))}},
                  fieldsOf({{"topic", name},
                            {"type", type},
                            {"md5sum", "1158d486dd51d683ce2f1be655c3c181"},
                            {"message_definition", "uint8[] data"}}));
}

BagBytes bagHeader(std::uint64_t index, std::size_t connections, std::size_t chunks) {
    const BagBytes fields =
        fieldsOf({{"op", op(3)},
                  {"index_pos", little(index)},
                  {"conn_count", little(static_cast<std::uint32_t>(connections))},
                  {"chunk_count", little(static_cast<std::uint32_t>(chunks))}});
    return sized(fields) + sized(BagBytes(4096 - fields.size(), ' '));
}

/** A chunk of a ROS 1 bag, and what its index says of it. */
class Ros1Chunk {
 public:
    void add(const BagContents& contents, std::size_t i, bool describe) {
        const BagMessage& message = contents.messages[i];
        const auto topic = static_cast<std::uint32_t>(message.topic);
        if (describe) bytes_ += connection(contents, message.topic);
        entries_[topic] +=
            bagTime(message.log_s) + little(static_cast<std::uint32_t>(bytes_.size()));
        bytes_ += record({{"op", op(2)}, {"conn", little(topic)}, {"time", bagTime(message.log_s)}},
                         message.bytes);
        if (first_.empty()) first_ = bagTime(message.log_s);
        last_ = bagTime(message.log_s);
    }
    bool empty() const { return bytes_.empty(); }

    BagBytes written(const std::string& compression) const {
        BagBytes out = record({{"op", op(5)},
                               {"compression", compression},
                               {"size", little(static_cast<std::uint32_t>(bytes_.size()))}},
                              pack(compression, bytes_));
        for (const auto& [topic, entries] : entries_)
            out += record({{"op", op(4)},
                           {"ver", little(std::uint32_t{1})},
                           {"conn", little(topic)},
                           {"count", little(static_cast<std::uint32_t>(entries.size() / 12))}},
                          entries);
        return out;
    }
    BagBytes info(std::uint64_t position) const {
        BagBytes counts;
        for (const auto& [topic, entries] : entries_)
            counts += little(topic) + little(static_cast<std::uint32_t>(entries.size() / 12));
        return record({{"op", op(6)},
                       {"ver", little(std::uint32_t{1})},
                       {"chunk_pos", little(position)},
                       {"start_time", first_},
                       {"end_time", last_},
                       {"count", little(static_cast<std::uint32_t>(entries_.size()))}},
                      counts);
    }

 private:
    BagBytes bytes_, first_, last_;
    std::map<std::uint32_t, BagBytes> entries_;
};

void save(const std::filesystem::path& file, const BagBytes& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}
}  // namespace

void writeRos1Bag(const std::filesystem::path& file, const BagContents& contents,
                  const std::string& compression, Index index, std::size_t perChunk) {
    const std::string magic = "#ROSBAG V2.0\n";
    const std::size_t start = magic.size() + 4096 + 8;
    BagBytes body, infos, connections;
    std::size_t chunks = 0;
    std::vector<bool> described(contents.topics.size());
    for (std::size_t i = 0; i < contents.messages.size();) {
        Ros1Chunk chunk;
        for (std::size_t k = 0; k < perChunk && i < contents.messages.size(); ++k, ++i) {
            chunk.add(contents, i, !described[contents.messages[i].topic]);
            described[contents.messages[i].topic] = true;
        }
        infos += chunk.info(start + body.size());
        body += chunk.written(compression);
        ++chunks;
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < contents.topics.size(); ++i) {
        if (!described[i]) continue;
        connections += connection(contents, i);
        ++count;
    }
    if (index == Index::kNever)
        save(file, magic + bagHeader(0, 0, 0) + body);
    else
        save(file,
             magic + bagHeader(start + body.size(), count, chunks) + body + connections + infos);
}

namespace {
BagBytes mcapRecord(int kind, const BagBytes& bytes) {
    return op(kind) + little(static_cast<std::uint64_t>(bytes.size())) + bytes;
}

BagBytes mcapChannels(const BagContents& contents) {
    BagBytes bytes;
    for (std::size_t i = 0; i < contents.topics.size(); ++i) {
        const auto id = static_cast<std::uint16_t>(i + 1);
        const auto& [name, type] = contents.topics[i];
        bytes += mcapRecord(3, little(id) + sized(type) + sized("ros1msg") + sized("uint8[] data"));
        bytes += mcapRecord(
            4, little(id) + little(id) + sized(name) + sized(contents.encoding) + sized(""));
    }
    return bytes;
}

BagBytes mcapMessage(const BagMessage& message, std::uint32_t sequence) {
    const BagBytes time = little(nanoseconds(message.log_s));
    return mcapRecord(5, little(static_cast<std::uint16_t>(message.topic + 1)) + little(sequence) +
                             time + time + message.bytes);
}

BagBytes mcapChunk(const BagBytes& records, const std::string& compression) {
    const BagBytes packed = pack(compression, records);
    const auto crc = static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(records.data()), records.size()));
    return mcapRecord(6, BagBytes(16, '\0') + little(static_cast<std::uint64_t>(records.size())) +
                             little(crc) + sized(compression) +
                             little(static_cast<std::uint64_t>(packed.size())) + packed);
}

BagBytes mcapStatistics(const BagContents& contents) {
    BagBytes counts;
    for (std::size_t i = 0; i < contents.topics.size(); ++i) {
        std::uint64_t count = 0;
        for (const BagMessage& message : contents.messages) count += message.topic == i;
        counts += little(static_cast<std::uint16_t>(i + 1)) + little(count);
    }
    return mcapRecord(11, BagBytes(42, '\0') + sized(counts));
}
}  // namespace

void writeMcap(const std::filesystem::path& file, const BagContents& contents,
               const std::string& compression, Index index, std::size_t perChunk) {
    const std::string magic = "\x89MCAP0\r\n";
    BagBytes out = magic + mcapRecord(1, sized("ros1") + sized("test"));
    if (perChunk == 0) out += mcapChannels(contents);
    for (std::size_t i = 0; i < contents.messages.size();) {
        BagBytes records = perChunk ? mcapChannels(contents) : "";
        for (std::size_t k = 0; k < std::max<std::size_t>(perChunk, 1); ++k, ++i) {
            if (i == contents.messages.size()) break;
            records += mcapMessage(contents.messages[i], static_cast<std::uint32_t>(i));
        }
        out += perChunk ? mcapChunk(records, compression) : records;
    }
    out += mcapRecord(15, BagBytes(4, '\0'));
    const std::uint64_t summary = index == Index::kWritten ? out.size() : 0;
    if (summary) out += mcapChannels(contents) + mcapStatistics(contents);
    out += mcapRecord(2, little(summary) + BagBytes(12, '\0')) + magic;
    save(file, out);
}

namespace {
void execute(sqlite3* database, const std::string& sql) {
    if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
        throw std::runtime_error(sqlite3_errmsg(database));
}
}  // namespace

void writeDatabase(const std::filesystem::path& file, const BagContents& contents) {
    sqlite3* database = nullptr;
    sqlite3_open(file.c_str(), &database);
    execute(database,
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
            "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
            "INTEGER NOT NULL, data BLOB NOT NULL);"
            "CREATE INDEX timestamp_idx ON messages (timestamp ASC);BEGIN;");
    for (std::size_t i = 0; i < contents.topics.size(); ++i)
        execute(database, "INSERT INTO topics VALUES(" + std::to_string(i + 1) + ",'" +
                              contents.topics[i].name + "','" + contents.topics[i].type + "','" +
                              contents.encoding + "','')");
    sqlite3_stmt* row = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)", -1,
                       &row, nullptr);
    for (const BagMessage& message : contents.messages) {
        sqlite3_bind_int64(row, 1, static_cast<sqlite3_int64>(message.topic + 1));
        sqlite3_bind_int64(row, 2, static_cast<sqlite3_int64>(nanoseconds(message.log_s)));
        sqlite3_bind_blob(row, 3, message.bytes.data(), static_cast<int>(message.bytes.size()),
                          SQLITE_STATIC);
        sqlite3_step(row);
        sqlite3_reset(row);
    }
    sqlite3_finalize(row);
    execute(database, "COMMIT");
    sqlite3_close(database);
}

void changeDatabase(const std::filesystem::path& file, const std::string& sql) {
    sqlite3* database = nullptr;
    sqlite3_open(file.c_str(), &database);
    execute(database, sql);
    sqlite3_close(database);
}

void writeMetadata(const std::filesystem::path& folder, const BagContents& contents,
                   const std::vector<std::string>& files) {
    std::ofstream out(folder / "metadata.yaml");
    out << "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n"
        << "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n";
    for (const std::string& file : files) out << "    - " << file << "\n";
    out << "  topics_with_message_count:\n";
    for (std::size_t i = 0; i < contents.topics.size(); ++i) {
        std::size_t count = 0;
        for (const BagMessage& message : contents.messages) count += message.topic == i;
        out << "    - topic_metadata:\n        name: " << contents.topics[i].name
            << "\n        type: " << contents.topics[i].type
            << "\n        serialization_format: cdr\n      message_count: " << count << "\n";
    }
}
}  // namespace delio::test
