#include "ros2_database.h"

#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "../most_bytes.h"
#include "delio/core/error.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
const std::string kMagic("SQLite format 3\0", 16);
const std::string kZstd = "\x28\xB5\x2F\xFD";

[[noreturn]] void fault(sqlite3* database) {
    const std::string what = database ? sqlite3_errmsg(database) : "no memory";
    throw Error("cannot be read as a ROS 2 database (" + what + ")");
}

/** A big-endian number of the database's header. */
std::uint64_t numberAt(const std::string& header, std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
        value = value << 8U | static_cast<std::uint8_t>(header[at + i]);
    return value;
}

void checkHeader(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    std::string header(100, '\0');
    if (!in) throw Error("cannot be opened");
    in.read(header.data(), static_cast<std::streamsize>(header.size()));
    if (header.compare(0, kZstd.size(), kZstd) == 0)
        throw Error("is compressed: unpack it first (zstd -d)");
    if (header.compare(0, kMagic.size(), kMagic) != 0)
        throw Error("is not a ROS 2 database (sqlite3)");
    // sqlite3 takes what is missing of its last page for zeros. A page size of 1 is 65536; the
    // number of pages is right if it is of the same change as the file.
    const std::uint64_t page = numberAt(header, 16, 2), pages = numberAt(header, 28, 4);
    const std::uint64_t bytes = fs::file_size(path);
    const std::uint64_t least = pages * (page == 1 ? 65536 : page);
    if (numberAt(header, 24, 4) == numberAt(header, 92, 4) && bytes < least)
        throw Error("is cut off at byte " + std::to_string(bytes) + " of " + std::to_string(least));
}
}  // namespace

Ros2Database::Query::~Query() { sqlite3_finalize(statement_); }
Ros2Database::Handle::~Handle() { sqlite3_close_v2(database); }

void Ros2Database::Query::prepare(sqlite3* database, const std::string& sql) {
    database_ = database;
    if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK)
        fault(database);
}

bool Ros2Database::Query::step() {
    const int code = sqlite3_step(statement_);
    if (code != SQLITE_ROW && code != SQLITE_DONE) fault(database_);
    return code == SQLITE_ROW;
}

void Ros2Database::Query::restart() { sqlite3_reset(statement_); }

void Ros2Database::Query::bind(int parameter, std::int64_t value) {
    sqlite3_bind_int64(statement_, parameter, value);
}

void Ros2Database::Query::bind(int parameter, const std::string& value) {
    sqlite3_bind_text(statement_, parameter, value.data(), static_cast<int>(value.size()),
                      SQLITE_TRANSIENT);
}

std::int64_t Ros2Database::Query::integer(int column) {
    return sqlite3_column_int64(statement_, column);
}

std::string Ros2Database::Query::text(int column) {
    const Bytes bytes = blob(column);
    return std::string(reinterpret_cast<const char*>(bytes.data), bytes.size);
}

Bytes Ros2Database::Query::blob(int column) {
    const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
    const int bytes = sqlite3_column_bytes(statement_, column);
    return {data, data ? static_cast<std::size_t>(bytes) : 0};
}

Ros2Database::Ros2Database(const std::string& path) : path_(path) {
    checkHeader(path);
    const int code =
        sqlite3_open_v2(path.c_str(), &handle_.database, SQLITE_OPEN_READONLY, nullptr);
    if (code != SQLITE_OK) fault(handle_.database);
    distrust();
    list();
}

void Ros2Database::distrust() {
    // Views and computed columns run programs of the file's own, which need not end.
    sqlite3_db_config(handle_.database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    Query computed;
    computed.prepare(handle_.database,
                     "SELECT (SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name IN "
                     "('topics', 'messages') AND sql NOT LIKE 'CREATE VIRTUAL%'), (SELECT COUNT(*) "
                     "FROM pragma_table_xinfo('topics') WHERE hidden <> 0) + (SELECT COUNT(*) "
                     "FROM pragma_table_xinfo('messages') WHERE hidden <> 0)");
    computed.step();
    if (computed.integer(0) != 2 || computed.integer(1) != 0)
        throw Error("has no tables 'topics' and 'messages', so it is no ROS 2 database");
    // Nothing in it is longer than the file.
    constexpr std::uintmax_t kLeast = 1 << 20;
    const auto bytes = std::clamp<std::uintmax_t>(fs::file_size(path_), kLeast, kMostBytes);
    sqlite3_limit(handle_.database, SQLITE_LIMIT_LENGTH, static_cast<int>(bytes));
}

void Ros2Database::list() {
    Query topics;
    topics.prepare(handle_.database,
                   "SELECT name, type, (SELECT COUNT(*) FROM messages WHERE topic_id = topics.id) "
                   "FROM topics ORDER BY id");
    while (topics.step())
        addTopic(topics_,
                 {topics.text(0), topics.text(1), static_cast<std::size_t>(topics.integer(2))});
}

void Ros2Database::start() {
    for (const Topic& topic : topics_)
        if (!only_ || topic.name == *only_) rows_ += topic.messages.value_or(0);
    const std::string one =
        only_ ? " WHERE topic_id IN (SELECT id FROM topics WHERE name = ?1)" : "";
    order_.prepare(handle_.database, "SELECT id FROM messages" + one + " ORDER BY timestamp, id");
    if (only_) order_.bind(1, *only_);
    contents_.prepare(handle_.database,
                      "SELECT t.name, t.type, t.serialization_format, m.timestamp, m.data FROM "
                      "messages m JOIN topics t ON t.id = m.topic_id WHERE m.id = ?1");
}

std::optional<Message> Ros2Database::next() {
    if (!order_.prepared()) start();
    if (!order_.step()) return std::nullopt;
    contents_.restart();
    contents_.bind(1, order_.integer(0));
    if (!contents_.step()) throw Error("is damaged: a message's row is missing");
    ++read_;
    const std::string format = contents_.text(2);  // some writers leave it empty
    return Message{contents_.text(0), contents_.text(1),
                   encodingOf(format.empty() ? "cdr" : format),
                   1e-9 * static_cast<double>(contents_.integer(3)), contents_.blob(4)};
}

double Ros2Database::fraction() const {
    return rows_ ? static_cast<double>(read_) / static_cast<double>(rows_) : 0;
}
}  // namespace delio::io
