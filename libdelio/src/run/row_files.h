#pragma once
#include <cstdio>
#include <filesystem>
#include <memory>

#include "delio/run/run_record.h"

namespace delio::run {
/** scans.csv and the odometry's trajectory of a drive that goes on, row by row. */
class RowFiles {
 public:
    /** Empty, in `folder`. Error where they cannot be made. */
    explicit RowFiles(const std::filesystem::path& folder);

    /** Each of these: Error where the disk is full. */
    void add(const RunRow& row, const Eigen::Isometry3d& pose);
    /** What was added is the system's, whatever happens to this process. */
    void flush();

 private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    struct File {
        std::filesystem::path path;
        std::unique_ptr<std::FILE, Close> file;
        void write(const std::string& line);
        void flush();
    };
    File scans_, trajectory_;
    bool hasHeading_ = false;
};
}  // namespace delio::run
