#include "delio/run/save_rawlog.h"

#include <cmath>
#include <filesystem>
#include <vector>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/files/output.h"
#include "delio/formats/drive_meta.h"
#include "mrpt/clock.h"
#include "recordings/decode_observation.h"
#include "recordings/rawlog_copy.h"

namespace delio::run {
namespace fs = std::filesystem;

namespace {
constexpr const char* kSideFiles[] = {".meta.yaml", ".times.txt", ".calib.txt", ".poses.txt"};
constexpr double kSameStamp_s = 1e-6;  // MRPT's clock counts in 100 ns

/** Motions of the vehicle between the scans of a record. */
class MotionsOf {
 public:
    MotionsOf(const RunRecord& record, const RawlogCopy& copy) : record_(record), copy_(copy) {
        covariances_.resize(record.rows.size(), kNone);
        for (const auto& edge : record.graph.edges())
            if (edge.to == edge.from + 1 && edge.to < covariances_.size())
                covariances_[edge.to] = edge.increment.covariance;
    }

    /** See io::MotionsUpTo. */
    std::optional<io::Motions> upTo(const mrpt::obs::CObservation& observation) {
        const bool mayBe = io::isScan(observation) && (observation.sensorLabel.empty() ||
                                                       observation.sensorLabel == copy_.label);
        if (!mayBe) return {};
        const double stamp_s = io::secondsSince(copy_.epoch_s, observation.timestamp);
        const auto& rows = record_.rows;
        std::size_t row = next_;
        while (row < rows.size() && rows[row].stamp_s < stamp_s - kSameStamp_s) ++row;
        if (row >= rows.size() || std::abs(rows[row].stamp_s - stamp_s) > kSameStamp_s) return {};
        io::Motions motions;
        if (found_ == 0) next_ = row;
        for (; next_ <= row; ++next_) motions.push_back(motionTo(next_));
        ++found_;
        return motions;
    }
    std::size_t found() const { return found_; }

 private:
    Increment motionTo(std::size_t row) const {
        if (found_ == 0) return {Eigen::Isometry3d::Identity(), kNone};
        const auto& poses = record_.final.poses;
        return {normalised(Eigen::Isometry3d(poses[row - 1].inverse() * poses[row])),
                covariances_[row]};
    }

    static inline const Matrix6 kNone = 1e-12 * Matrix6::Identity();  // of no motion
    const RunRecord& record_;
    const RawlogCopy& copy_;
    std::vector<Matrix6> covariances_;
    std::size_t next_ = 0, found_ = 0;
};

/** Where the input's external files are; empty if it has none. */
fs::path imagesOf(const RawlogCopy& copy) {
    if (!copy.imagesFolder.empty()) return fs::absolute(copy.imagesFolder);
    for (const fs::path& folder : {fs::path(io::sidecarPath(copy.input, "_Images")),
                                   fs::path(copy.input).parent_path() / "Images"})
        if (fs::is_directory(folder)) return fs::absolute(folder);
    return {};
}
}  // namespace

std::vector<std::string> filesOfCopy(const std::string& output) {
    std::vector<std::string> files = {output, io::sidecarPath(output, "_Images")};
    for (const char* side : kSideFiles) files.push_back(io::sidecarPath(output, side));
    return files;
}

RawlogCopyReport saveRawlog(const RunRecord& record, const RawlogCopy& copy) {
    const fs::path output = copy.output;
    io::PartialFolder partial(io::folderOf(output), copy.output);
    try {
        const std::string made = (partial.path() / output.filename()).string();
        RawlogCopyReport report;
        MotionsOf motions(record, copy);
        io::copyWithActions(copy.input, made,
                            [&](const auto& observation) { return motions.upTo(observation); });
        report.actions = motions.found();
        report.unmatched = record.rows.size() - report.actions;
        if (const auto images = imagesOf(copy); !images.empty())
            fs::create_directory_symlink(images, io::sidecarPath(made, "_Images"));
        for (const char* side : kSideFiles)
            if (fs::is_regular_file(io::sidecarPath(copy.input, side)))
                fs::copy_file(io::sidecarPath(copy.input, side), io::sidecarPath(made, side));
        std::vector<std::string> names;
        for (const auto& file : filesOfCopy(output.filename().string())) names.push_back(file);
        partial.putInPlace(names);
        return report;
    } catch (const std::exception& e) {
        throw Error(partial.asInPlace(plainMessage(e)));
    }
}
}  // namespace delio::run
