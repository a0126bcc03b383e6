#pragma once
#include <mrpt/obs/CObservationPointCloud.h>

#include <memory>

#include "../io/spool.h"

namespace delio::map {
/** A CObservationPointCloud whose points are fetched from the disk while they are needed: a
 *  simplemap of such scans is written with one of them in memory at a time, and what is written is
 *  a plain CObservationPointCloud with its points embedded. */
class SpooledScan : public mrpt::obs::CObservationPointCloud {
 public:
    SpooledScan(std::shared_ptr<const io::Spool> spool, io::Spool::Place place, bool withIntensity)
        : spool_(std::move(spool)), place_(place), withIntensity_(withIntensity) {}

    void load() const override;
    void unload() const override;
    mrpt::rtti::CObject* clone() const override { return new SpooledScan(*this); }

 protected:
    void serializeTo(mrpt::serialization::CArchive& out) const override;

 private:
    std::shared_ptr<const io::Spool> spool_;
    io::Spool::Place place_;
    bool withIntensity_;
};
}  // namespace delio::map
