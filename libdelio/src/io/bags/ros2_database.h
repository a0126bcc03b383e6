#pragma once
#include <cstdint>

#include "message_source.h"

struct sqlite3;
struct sqlite3_stmt;

namespace delio::io {
/** Reads a ROS 2 bag of sqlite3 (.db3), in the order of its times. */
class Ros2Database : public MessageSource {
 public:
    /** Throws Error if it cannot be opened, is no such database, or is compressed. */
    explicit Ros2Database(const std::string& path);

    const std::vector<Topic>& topics() const override { return topics_; }
    void only(const std::string& topic) override { only_ = topic; }
    std::optional<Message> next() override;
    double fraction() const override;
    const std::string& path() const override { return path_; }

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

    std::string path_;
    Handle handle_;
    std::vector<Topic> topics_;
    std::optional<std::string> only_;
    /** Order first, contents after: no sorting of contents where there is no index. */
    Query order_, contents_;
    std::size_t rows_ = 0, read_ = 0;
};
}  // namespace delio::io
