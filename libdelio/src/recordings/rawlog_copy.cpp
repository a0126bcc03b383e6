#include "rawlog_copy.h"

#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include "delio/core/error.h"
#include "delio/graph/pose_graph.h"
#include "files/gz.h"
#include "mrpt/object_archive.h"

namespace delio::io {
using mrpt::obs::CObservation;

namespace {
mrpt::poses::CPose3DPDFGaussian composed(const Motions& motions) {
    auto whole = graph::posePdfOf(motions.front());
    for (std::size_t i = 1; i < motions.size(); ++i) whole += graph::posePdfOf(motions[i]);
    return whole;
}

/** Copies the objects of one file to another. */
class Copier {
 public:
    Copier(const std::string& input, const std::string& output, const MotionsUpTo& motionsUpTo)
        : motionsUpTo_(motionsUpTo),
          in_(input),
          bytes_(input),
          objects_(in_, FileOf::Scans),
          out_(output),
          archive_(mrpt::serialization::archiveFrom(out_)) {}

    void run() {
        while (const auto object = next()) put(object);
        flushAction();
        out_.close();
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
        std::optional<Motions> motion;
        mrpt::Clock::time_point time;
        const auto ask = [&](const CObservation& each) {
            if (motion) return;
            motion = motionsUpTo_(each);
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

    void putAction(const Motions& motions, mrpt::Clock::time_point time) {
        mrpt::obs::CActionCollection collection;
        if (action_) collection = *action_;
        mrpt::obs::CActionRobotMovement3D movement;
        movement.timestamp = time;
        movement.poseChange = composed(motions);
        movement.rawOdometryIncrementReading = movement.poseChange.mean;
        movement.estimationMethod = mrpt::obs::CActionRobotMovement3D::emVisualOdometry;
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
            throw Error("the rawlog cannot be written: the disk is full");
    }

    const MotionsUpTo& motionsUpTo_;
    GzInput in_, bytes_;  //!< the same file, for objects and for their bytes
    ObjectArchive objects_;
    mrpt::io::CFileOutputStream out_;
    mrpt::serialization::CArchiveStreamBase<mrpt::io::CFileOutputStream> archive_;
    mrpt::obs::CActionCollection::Ptr action_;  //!< of the input, not written yet
    std::vector<char> actionBytes_;
};
}  // namespace

void copyWithActions(const std::string& input, const std::string& output,
                     const MotionsUpTo& motionsUpTo) {
    Copier(input, output, motionsUpTo).run();
}
}  // namespace delio::io
