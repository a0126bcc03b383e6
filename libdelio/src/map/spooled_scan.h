#pragma once
#include <mrpt/obs/CObservationPointCloud.h>

#include <memory>

#include "stored_scan.h"
#include "visibility_votes.h"

namespace delio::map {
/** A CObservationPointCloud whose points, without those that are dynamic, are fetched from the disk
 * while they are needed: a simplemap of such scans is written with one of them in memory at a time,
 * and what is written is a plain CObservationPointCloud with its points embedded. */
class SpooledScan : public mrpt::obs::CObservationPointCloud {
 public:
    SpooledScan(std::shared_ptr<const io::Spool> spool, const StoredScan& scan,
                const Eigen::Isometry3d& sensorInWorld,
                std::shared_ptr<const VisibilityVotes> votes)
        : spool_(std::move(spool)),
          place_(scan.stillPoints()),
          withIntensity_(scan.withIntensity),
          sensorInWorld_(sensorInWorld),
          votes_(std::move(votes)) {}

    void load() const override;
    void unload() const override;
    mrpt::rtti::CObject* clone() const override { return new SpooledScan(*this); }

 protected:
    void serializeTo(mrpt::serialization::CArchive& out) const override;

 private:
    std::shared_ptr<const io::Spool> spool_;
    io::Spool::Place place_;
    bool withIntensity_;
    Eigen::Isometry3d sensorInWorld_;
    std::shared_ptr<const VisibilityVotes> votes_;
};
}  // namespace delio::map
