#pragma once
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "delio/recordings/scan_reader.h"

namespace delio::io {
/** A reader whose scans lack the points of parts of the own vehicle. */
class WithoutVehicle : public ScanReader {
 public:
    WithoutVehicle(std::unique_ptr<ScanReader> source, std::vector<VehiclePart> parts)
        : source_(std::move(source)), parts_(std::move(parts)), inside_(parts_.size()) {}

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
    /** Warns of parts without any point. */
    Recording recording() const override;
    earth::Fixes takeFixes() override { return source_->takeFixes(); }
    std::optional<LiveReport> live() const override { return source_->live(); }
    std::optional<double> received_s() const override { return source_->received_s(); }
    SideFile calibration() const override { return source_->calibration(); }
    SideFile truth() const override { return source_->truth(); }

 private:
    std::unique_ptr<ScanReader> source_;
    std::vector<VehiclePart> parts_;
    std::size_t scans_ = 0;
    std::vector<std::size_t> inside_;  //!< points in each part
};

/** `source` itself where there are no parts. */
std::unique_ptr<ScanReader> without(std::vector<VehiclePart> parts,
                                    std::unique_ptr<ScanReader> source);

std::vector<VehiclePart> boxesOf(const std::vector<VehiclePart>& parts);

/** Sectors of the sensor with this label; empty: of all sensors. */
std::vector<VehiclePart> sectorsOf(const std::vector<VehiclePart>& parts, const std::string& label);
}  // namespace delio::io
