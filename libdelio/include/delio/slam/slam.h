#pragma once
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "delio/formats/trajectory.h"
#include "delio/odometry/odometry.h"
#include "delio/slam/listener.h"

namespace delio {
/** What became of one scan. */
struct ScanReport {
    Step step;                        //!< of the odometry
    std::vector<Named> listeners_ms;  //!< time of each listener, under its name

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(step, listeners_ms);
    }
};

/** An odometry and its listeners: scans in, and each listener is told of every step in turn. Poses
 *  are the vehicle's: they map its coordinates to those it had at the first scan. */
class Slam {
 public:
    /** Without listeners yet. `history`: which poses trajectory() keeps. */
    explicit Slam(std::unique_ptr<Odometry> odometry, History history = History::All)
        : odometry_(std::move(odometry)), history_(history) {}

    /** From the next scan on it is told of every scan, after those that were attached before. */
    void attach(std::shared_ptr<SlamListener> listener);

    /** Where the odometry or a listener throws, trajectory and listeners are as they were before,
     *  as if the scan had not been recorded: how far it led is counted to the next one. (Not where
     *  that is not known: the odometry threw, or gave an increment that is not finite, which is an
     *  Error.) */
    ScanReport process(const Scan& scan);

    /** No more scans come: what the odometry has kept to register them goes, and with it what
     *  process() and save() need; they are an Error from then on. */
    void close() { odometry_.reset(); }

    /** Of the odometry alone: the poses of all scans, or the last one (see History). */
    const io::Trajectory& trajectory() const { return trajectory_; }

    /** The drive as far as it has come, with odometry and listeners: written between two scans, it
     *  is gone on with from there. Error where something of it cannot be written. */
    void save(std::ostream& out) const;
    /** Into one with an odometry and listeners that were made alike, attached in the same order,
     *  and that has seen no scan. Error where the state is cut off, damaged, of other options, of
     *  other listeners or of another version; then this is of no use. */
    void restore(std::istream& in);

    /** What has to be kept to go on later: see core/checkpoint.h. */
    template <class Archive>
    void serialize(Archive& archive) {
        archive(trajectory_, nodes_, sensorPose_, refused_);
    }

 private:
    void requireOpen() const;
    std::string listenerNames() const;
    void tell(const SlamScan& scan, ScanReport& report);

    std::unique_ptr<Odometry> odometry_;
    std::vector<std::shared_ptr<SlamListener>> listeners_;
    History history_;
    io::Trajectory trajectory_;
    std::size_t nodes_ = 0;  //!< scans that were taken
    /** Sensor in the vehicle at the last scan that was taken. */
    Eigen::Isometry3d sensorPose_ = Eigen::Isometry3d::Identity();
    /** From the last scan that was taken to the one that was refused after it, of the sensor. */
    std::optional<Increment> refused_;
};
}  // namespace delio
