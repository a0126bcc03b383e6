#pragma once
#include <bitset>
#include <deque>
#include <exception>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "delio/recordings/scan_reader.h"
#include "findings.h"

namespace delio::io {
/** Directions about the sensor's z axis in which a scan has points, 4 deg wide each. */
using Sectors = std::bitset<90>;
Sectors sectorsOf(const Scan& scan);

/** A reader of whole turns. Where the messages of a recording hold a part of a turn each (halves,
 *  quarters, or two drivers for two halves), consecutive ones are put together until the next one
 *  covers the same directions again. Looks at the first scans to see that. A sensor that looks to
 *  one side only covers the same directions every time: its scans stay as they are. */
class TurnAssembler : public ScanReader {
 public:
    explicit TurnAssembler(std::unique_ptr<ScanReader> source);

    std::optional<Scan> next() override;
    bool skip() override;
    std::vector<ImuSample> takeImu() override { return source_->takeImu(); }
    std::vector<OdometrySample> takeOdometry() override { return source_->takeOdometry(); }
    const std::string& label() const override { return source_->label(); }
    const std::set<std::string>& otherLabels() const override { return source_->otherLabels(); }
    std::optional<SensorMount> mount() override { return source_->mount(); }
    std::optional<double> fraction() const override;
    const std::optional<DriveMeta>& meta() const override { return source_->meta(); }
    Recording recording() const override;
    earth::Fixes takeFixes() override { return source_->takeFixes(); }
    SideFile calibration() const override { return source_->calibration(); }
    /** None for turns: its rows are those of the parts. */
    SideFile truth() const override { return areParts_ ? SideFile{} : source_->truth(); }

 private:
    std::optional<Scan> nextPart();

    std::unique_ptr<ScanReader> source_;
    std::deque<Scan> ahead_;                       //!< parts
    std::deque<std::optional<double>> fractions_;  //!< of the drive, after each of them
    std::exception_ptr fault_;                     //!< comes after them
    bool areParts_ = false;
    std::optional<Scan> begun_;  //!< the turn that the latest part belongs to
    Sectors covered_;            //!< by it
    std::size_t turns_ = 0;
    Findings findings_;
};
}  // namespace delio::io
