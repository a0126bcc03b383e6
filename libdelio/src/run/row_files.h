#pragma once
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "delio/run/run_record.h"

namespace delio::run {
/** scans.csv and the odometry's trajectory of a drive in progress, in a folder of their own that is
 *  removed with this object. A killed process leaves the folder behind. */
class RowFiles {
 public:
    /** `folder` is made; what was in it is removed. Error where that fails. */
    explicit RowFiles(std::filesystem::path folder);
    ~RowFiles();
    RowFiles(const RowFiles&) = delete;
    RowFiles& operator=(const RowFiles&) = delete;

    /** Appends a row to both; they are flushed once a second. Error where the disk is full: the
     *  files are removed then, and later calls do nothing. */
    void add(const RunRow& row, const Eigen::Isometry3d& pose);

 private:
    using Clock = std::chrono::steady_clock;
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    struct File {
        std::filesystem::path path;
        std::unique_ptr<std::FILE, Close> file;
        std::string pending;  //!< whole lines only, so that the file has no others
        void flush();
    };
    void addTo(const RunRow& row, const Eigen::Isometry3d& pose);

    std::filesystem::path folder_;
    File scans_, trajectory_;
    bool hasHeading_ = false, givenUp_ = false;
    Clock::time_point flushAt_ = Clock::now();
};
}  // namespace delio::run
