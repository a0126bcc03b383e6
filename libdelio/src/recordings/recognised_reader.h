#pragma once
#include <deque>
#include <exception>
#include <memory>
#include <vector>

#include "delio/recordings/scan_reader.h"
#include "stamp_order.h"

namespace delio::io {
/** How scans come, and so how far a reader may look ahead. Scans are the same in any case. */
enum class Delivery {
    kFile,     //!< as fast as they are read
    kPipe,     //!< perhaps as they are measured; from a file or by a program
    kPackets,  //!< recorded packets: turns are in order
    kSensor    //!< packets, as they are measured
};

/** A reader whose recording() and meta() are whole from the beginning, and whose stamps rise (see
 *  StampOrder). It reads three scans with points ahead, of a sensor only one, and looks at these
 *  where the source does not say whether they were de-skewed. It looks again now and then: scans of
 *  a vehicle that stood first look as if they were not. */
class RecognisedReader : public ScanReader {
 public:
    explicit RecognisedReader(std::unique_ptr<ScanReader> source,
                              Delivery delivery = Delivery::kFile);

    std::optional<Scan> next() override;
    bool skip() override;
    std::vector<ImuSample> takeImu() override { return source_->takeImu(); }
    std::vector<OdometrySample> takeOdometry() override { return source_->takeOdometry(); }
    const std::string& label() const override { return source_->label(); }
    const std::set<std::string>& otherLabels() const override { return source_->otherLabels(); }
    std::optional<SensorMount> mount() override { return source_->mount(); }
    std::optional<double> fraction() const override { return fraction_; }
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override;
    earth::Fixes takeFixes() override { return source_->takeFixes(); }
    SideFile calibration() const override { return source_->calibration(); }
    SideFile truth() const override { return source_->truth(); }

 private:
    bool readOne();
    void dropUnfitTimes(Scan& scan);
    void readAhead();
    bool isNextKnown() const;
    void leaveOutFirst();
    void passed();
    void recognise();
    void lookAgain(const Scan& scan);

    std::unique_ptr<ScanReader> source_;
    Delivery delivery_;
    std::deque<Scan> ahead_;
    std::deque<std::optional<double>> fractions_;  //!< of the drive, after each scan that is ahead
    std::optional<double> fraction_;
    std::exception_ptr fault_;  //!< comes after the scans that are ahead
    bool ended_ = false;        //!< the source has no more scans
    StampOrder order_;
    bool began_ = false;  //!< next() was called
    Findings findings_;
    Recording recording_;
    std::optional<DriveMeta> meta_;
};
}  // namespace delio::io
