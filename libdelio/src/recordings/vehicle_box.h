#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "delio/recordings/scan_reader.h"

namespace delio::io {
/** A reader whose scans lack the points in a box around the own vehicle. */
class WithoutVehicle : public ScanReader {
 public:
    /** `box`: in the vehicle's frame, metres. */
    WithoutVehicle(std::unique_ptr<ScanReader> source, const Eigen::AlignedBox3d& box)
        : source_(std::move(source)), box_(box) {}

    std::optional<Scan> next() override;
    bool skip() override { return source_->skip(); }
    std::vector<ImuSample> takeImu() override { return source_->takeImu(); }
    std::vector<OdometrySample> takeOdometry() override { return source_->takeOdometry(); }
    const std::string& label() const override { return source_->label(); }
    const std::set<std::string>& otherLabels() const override { return source_->otherLabels(); }
    std::optional<SensorMount> mount() override { return source_->mount(); }
    std::vector<std::pair<std::string, Eigen::Isometry3d>> mergedSensors() const override {
        return source_->mergedSensors();
    }
    std::optional<double> fraction() const override { return source_->fraction(); }
    const std::optional<DriveMeta>& meta() const override { return source_->meta(); }
    /** Warns of a box without any point. */
    Recording recording() const override;
    earth::Fixes takeFixes() override { return source_->takeFixes(); }
    std::optional<LiveReport> live() const override { return source_->live(); }
    std::optional<double> received_s() const override { return source_->received_s(); }
    SideFile calibration() const override { return source_->calibration(); }
    SideFile truth() const override { return source_->truth(); }

 private:
    std::unique_ptr<ScanReader> source_;
    Eigen::AlignedBox3d box_;
    std::size_t scans_ = 0, inside_ = 0;  //!< points
};
}  // namespace delio::io
