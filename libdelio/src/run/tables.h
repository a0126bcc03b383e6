#pragma once
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "delio/formats/scan_table.h"
#include "delio/run/run_folder.h"
#include "delio/run/run_record.h"

namespace delio::run {
/** As scans.csv has it. */
io::ScanRow scanRowOf(const RunRow& row);

/** Writes loops.csv: a row for each pair of places that was compared, with the nodes of the pose
 *  graph, what was searched and found, and why it was refused (empty: it was accepted). Error where
 *  the file cannot be written. */
void writeLoopTable(const std::vector<places::LoopCandidate>& candidates, const std::string& path);

/** Throws Error with file and line where a column is missing or malformed. */
std::vector<LoopRow> readLoopTable(const std::string& path);

/** Writes localisation.csv, one row per scan: the vehicle's pose in the map as known at that time
 *  (unknown, in_map, outside; x y z and quaternion in the map's frame, and the upper triangle of
 *  the covariance in the order of delio::Increment), the inlier ratio, and why the pose was not
 *  measured. Throws Error if the file cannot be written. */
void writeLocalisationTable(const std::vector<RunRow>& rows, const std::vector<MapFix>& fixes,
                            const std::string& path);

/** Throws Error with file and line where a column is missing or malformed. */
std::vector<LocalisationRow> readLocalisationTable(const std::string& path);

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
