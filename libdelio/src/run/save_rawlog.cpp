#include "delio/run/save_rawlog.h"

#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <filesystem>
#include <vector>

#include "delio/core/error.h"
#include "delio/files/output_folder.h"
#include "delio/formats/drive_meta.h"
#include "delio/graph/pose_pdf.h"
#include "files/gz.h"
#include "mrpt/clock.h"
#include "mrpt/object_archive.h"
#include "recordings/decode_observation.h"

namespace delio::run {
namespace fs = std::filesystem;
using mrpt::obs::CObservation;

namespace {
constexpr const char* kSideFiles[] = {".meta.yaml", ".times.txt", ".calib.txt", ".poses.txt"};
constexpr double kSameStamp_s = 1e-6;  // MRPT's clock counts in 100 ns

/** Motions of the vehicle between the scans of a record. */
class Motions {
 public:
    Motions(const RunRecord& record, const RawlogCopy& copy) : record_(record), copy_(copy) {
        covariances_.resize(record.rows.size(), kNone);
        for (const auto& edge : record.graph.edges())
            if (edge.to == edge.from + 1 && edge.to < covariances_.size())
                covariances_[edge.to] = edge.increment.covariance;
    }

    /** The motion up to the scan `observation`, from the scan that this gave before; nothing where
     *  it is no scan of the record. */
    std::optional<mrpt::poses::CPose3DPDFGaussian> upTo(const CObservation& observation) {
        if (!io::isScan(observation)) return {};
        if (!observation.sensorLabel.empty() && observation.sensorLabel != copy_.label) return {};
        const double stamp_s = io::secondsSince(copy_.epoch_s, observation.timestamp);
        std::size_t row = next_;
        while (row < record_.rows.size() && record_.rows[row].stamp_s < stamp_s - kSameStamp_s)
            ++row;
        if (row >= record_.rows.size() ||
            std::abs(record_.rows[row].stamp_s - stamp_s) > kSameStamp_s)
            return {};
        mrpt::poses::CPose3DPDFGaussian motion = between(next_, row);
        next_ = row + 1;
        ++found_;
        return motion;
    }
    std::size_t found() const { return found_; }

 private:
    /** From row `from` - 1 to row `to`, one increment after the other. */
    mrpt::poses::CPose3DPDFGaussian between(std::size_t from, std::size_t to) const {
        if (found_ == 0) return graph::posePdfOf({Eigen::Isometry3d::Identity(), kNone});
        const auto& poses = record_.final.poses;
        mrpt::poses::CPose3DPDFGaussian motion;
        for (std::size_t row = from; row <= to; ++row) {
            const auto step = graph::posePdfOf(
                {normalised(Eigen::Isometry3d(poses[row - 1].inverse() * poses[row])),
                 covariances_[row]});
            if (row == from)
                motion = step;
            else
                motion += step;
        }
        return motion;
    }

    static inline const Matrix6 kNone = 1e-12 * Matrix6::Identity();  // of no motion
    const RunRecord& record_;
    const RawlogCopy& copy_;
    std::vector<Matrix6> covariances_;
    std::size_t next_ = 0, found_ = 0;
};

/** Copies the objects of one file to another. */
class Copier {
 public:
    Copier(const RunRecord& record, const RawlogCopy& copy, const std::string& output)
        : motions_(record, copy),
          copy_(copy),
          in_(copy.input),
          bytes_(copy.input),
          objects_(in_, io::FileOf::Scans),
          out_(output),
          archive_(mrpt::serialization::archiveFrom(out_)) {}

    std::size_t run() {
        while (const auto object = next()) put(object);
        flushAction();
        out_.close();
        return motions_.found();
    }

 private:
    /** Nothing at the end, and where the rest is damaged: the run said so. */
    mrpt::serialization::CSerializable::Ptr next() {
        try {
            return objects_.next();
        } catch (const std::exception&) {
            return nullptr;
        }
    }

    void put(const mrpt::serialization::CSerializable::Ptr& object) {
        if (const auto action = std::dynamic_pointer_cast<mrpt::obs::CActionCollection>(object)) {
            flushAction();
            action_ = action;  // gets the motion, if the next object is a scan
            const auto end = in_.getPosition();
            actionBytes_ = rawUpTo(end);
            return;
        }
        const auto observation = std::dynamic_pointer_cast<CObservation>(object);
        const auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object);
        std::optional<mrpt::poses::CPose3DPDFGaussian> motion;
        mrpt::Clock::time_point time;
        const auto ask = [&](const CObservation& each) {
            if (motion) return;
            motion = motions_.upTo(each);
            time = each.timestamp;
        };
        if (observation) ask(*observation);
        if (frame)
            for (const auto& each : *frame)
                if (each) ask(*each);
        const auto raw = rawUpTo(in_.getPosition());
        if (!motion) {
            flushAction();
            write(raw);
            return;
        }
        putAction(*motion, time);
        if (frame) {
            write(raw);
        } else {
            mrpt::obs::CSensoryFrame pair;
            pair.insert(observation);
            archive_ << pair;
        }
    }

    void putAction(const mrpt::poses::CPose3DPDFGaussian& motion, mrpt::Clock::time_point time) {
        mrpt::obs::CActionCollection collection;
        if (action_) collection = *action_;
        mrpt::obs::CActionRobotMovement3D movement;
        movement.timestamp = time;
        movement.poseChange = motion;
        movement.rawOdometryIncrementReading = motion.mean;
        movement.estimationMethod = mrpt::obs::CActionRobotMovement3D::emOdometry;
        collection.insert(movement);
        archive_ << collection;
        action_.reset();
        actionBytes_.clear();
    }

    void flushAction() {
        write(actionBytes_);
        action_.reset();
        actionBytes_.clear();
    }

    /** Bytes of the objects that were read since the last call. */
    std::vector<char> rawUpTo(std::uint64_t end) {
        std::vector<char> raw(end - bytes_.getPosition());
        bytes_.Read(raw.data(), raw.size());
        return raw;
    }
    void write(const std::vector<char>& raw) {
        if (out_.Write(raw.data(), raw.size()) != raw.size())
            throw Error("cannot write '" + copy_.output + "': the disk is full");
    }

    Motions motions_;
    const RawlogCopy& copy_;
    io::GzInput in_, bytes_;  //!< the same file, for objects and for their bytes
    io::ObjectArchive objects_;
    mrpt::io::CFileOutputStream out_;
    mrpt::serialization::CArchiveStreamBase<mrpt::io::CFileOutputStream> archive_;
    mrpt::obs::CActionCollection::Ptr action_;  //!< of the input, not written yet
    std::vector<char> actionBytes_;
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
        report.actions = Copier(record, copy, made).run();
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
