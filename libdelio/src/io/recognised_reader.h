#pragma once
#include <deque>
#include <exception>
#include <memory>

#include "delio/io/scan_reader.h"

namespace delio::io {
/** A reader whose recording() and meta() are whole from the beginning: it reads three scans ahead,
 *  and looks at the points where the source does not say whether they were de-skewed. That is
 *  looked at again now and then: a vehicle that stood first looks as if they were not. */
class RecognisedReader : public ScanReader {
 public:
    explicit RecognisedReader(std::unique_ptr<ScanReader> source);

    std::optional<Scan> next() override;
    bool skip() override;
    const std::string& label() const override { return source_->label(); }
    const std::set<std::string>& otherLabels() const override { return source_->otherLabels(); }
    std::optional<double> fraction() const override { return source_->fraction(); }
    const std::optional<DriveMeta>& meta() const override { return meta_; }
    Recording recording() const override { return recording_; }
    SideFile calibration() const override { return source_->calibration(); }
    SideFile truth() const override { return source_->truth(); }

 private:
    void readAhead();
    void recognise();
    void lookAgain(const Scan& scan);

    std::unique_ptr<ScanReader> source_;
    std::deque<Scan> ahead_;
    std::exception_ptr fault_;  //!< comes after the scans that are ahead
    Recording recording_;
    std::optional<DriveMeta> meta_;
};
}  // namespace delio::io
