#include <sqlite3.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "delio/core/error.h"
#include "files/input_file.h"
#include "files/names.h"
#include "message_source.h"

namespace delio::io {
namespace fs = std::filesystem;

namespace {
/** Reads a ROS 2 bag of sqlite3 (.db3), in the order of its times. */
class Ros2Database : public MessageSource {
 public:
    /** Throws Error if it cannot be opened, is no such database, or is compressed. */
    explicit Ros2Database(const std::string& path);

    std::optional<Message> next() override;
    double fraction() const override;

 private:
    /** Rows of a query, one at a time. */
    class Query {
     public:
        Query() = default;
        ~Query();
        Query(const Query&) = delete;
        Query& operator=(const Query&) = delete;
        void prepare(sqlite3* database, const std::string& sql);
        bool prepared() const { return statement_ != nullptr; }
        bool step();
        void restart();
        void bind(int parameter, std::int64_t value);
        void bind(int parameter, const std::string& value);
        std::int64_t integer(int column);
        std::string text(int column);
        Bytes blob(int column);

     private:
        sqlite3* database_ = nullptr;
        sqlite3_stmt* statement_ = nullptr;
    };
    struct Handle {
        ~Handle();
        sqlite3* database = nullptr;
    };

    void distrust();
    void list();
    void start();

    Handle handle_;
    /** Order first, contents after: no sorting of contents where there is no index. */
    Query order_, contents_;
    std::size_t rows_ = 0, read_ = 0;
};

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
        throw Error("is compressed; decompress it first (zstd -d)");
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

Ros2Database::Ros2Database(const std::string& path) : MessageSource(path) {
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
        throw Error("is not a ROS 2 database: no tables 'topics' and 'messages'");
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
        if (isWanted(topic.name)) rows_ += topic.messages.value_or(0);
    std::string some;
    for (std::size_t i = 0; i < only_.size(); ++i)
        some += (i == 0 ? " WHERE topic_id IN (SELECT id FROM topics WHERE name IN (?" : ", ?") +
                std::to_string(i + 1);
    if (!some.empty()) some += "))";
    order_.prepare(handle_.database, "SELECT id FROM messages" + some + " ORDER BY timestamp, id");
    for (std::size_t i = 0; i < only_.size(); ++i) order_.bind(static_cast<int>(i + 1), only_[i]);
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

/** Reads the folder of a ROS 2 bag: the .db3 or .mcap files that its metadata.yaml names, one after
 *  the other. */
class Ros2Folder : public MessageSource {
 public:
    /** Throws Error where metadata.yaml is missing or cannot be understood, names no files, or
     *  says that they are compressed, and as the first file's source. */
    explicit Ros2Folder(const std::string& folder);

    void only(const std::vector<std::string>& topics) override;
    std::optional<Message> next() override;
    double fraction() const override;

 private:
    void readMetadata(const std::string& yaml);
    void open();

    std::string folder_;
    std::vector<std::string> files_;
    std::unique_ptr<MessageSource> source_;
    std::size_t done_ = 0;
};

Ros2Folder::Ros2Folder(const std::string& folder)
    : MessageSource((fs::path(folder) / "metadata.yaml").string()), folder_(folder) {
    if (!fs::is_regular_file(path_)) throw Error("has no metadata.yaml");
    try {
        readMetadata(path_);
    } catch (const YAML::Exception& e) {
        throw Error("has an invalid metadata.yaml (" + e.msg + ")");
    }
    if (files_.empty()) throw Error("has a metadata.yaml that names no files");
    try {
        open();
    } catch (const Error& e) {
        throw Error("has '" + files_.front() + "', which " + e.what());
    }
    if (topics_.empty()) topics_ = source_->topics();
}

void Ros2Folder::readMetadata(const std::string& yaml) {
    const YAML::Node bag = YAML::LoadFile(yaml)["rosbag2_bagfile_information"];
    if (!bag || !bag.IsMap()) throw Error("has a metadata.yaml that does not describe a ROS 2 bag");
    const auto mode = bag["compression_mode"] ? bag["compression_mode"].as<std::string>() : "";
    if (!mode.empty() && mode != "NONE" && mode != "none")
        throw Error("is compressed; convert it first (ros2 bag convert)");
    for (const auto& file : bag["relative_file_paths"]) {
        // Older bags have their own folder's name in it.
        const fs::path name = file.as<std::string>(), inside = fs::path(folder_) / name;
        const bool isThere = staysInside(name) && fs::exists(inside);
        files_.push_back((isThere ? inside : fs::path(folder_) / name.filename()).string());
    }
    for (const auto& topic : bag["topics_with_message_count"]) {
        const auto about = topic["topic_metadata"];
        addTopic(topics_, {about["name"].as<std::string>(), about["type"].as<std::string>(),
                           topic["message_count"].as<std::size_t>()});
    }
}

void Ros2Folder::open() {
    path_ = files_[done_];
    const std::string extension = fs::path(path_).extension().string();
    if (!fs::is_regular_file(path_)) throw Error("is named in metadata.yaml but does not exist");
    if (extension == ".mcap")
        source_ = mcapSource(path_);
    else
        source_ = std::make_unique<Ros2Database>(path_);
    source_->only(only_);
}

void Ros2Folder::only(const std::vector<std::string>& topics) {
    only_ = topics;
    source_->only(topics);
}

std::optional<Message> Ros2Folder::next() {
    while (true) {
        if (auto message = source_->next()) return message;
        if (done_ + 1 >= files_.size()) return std::nullopt;
        ++done_;
        open();
    }
}

double Ros2Folder::fraction() const {
    return (static_cast<double>(done_) + source_->fraction()) / static_cast<double>(files_.size());
}
}  // namespace

std::unique_ptr<MessageSource> ros2DatabaseSource(const std::string& path) {
    return std::make_unique<Ros2Database>(path);
}

std::unique_ptr<MessageSource> ros2FolderSource(const std::string& folder) {
    return std::make_unique<Ros2Folder>(folder);
}
}  // namespace delio::io
