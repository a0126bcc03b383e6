#pragma once
#include <mrpt/poses/CPose3D.h>

#include <memory>
#include <string>
#include <vector>

#include "delio/odometry/prediction.h"
#include "delio/scan/preprocess.h"
#include "delio/scan/scan.h"

namespace delio::benchmark {
/** An odometry that is measured beside the others. */
class Baseline {
 public:
    virtual ~Baseline() = default;
    virtual void process(const Scan& scan) = 0;
    /** After the last scan: poses of the sensor, the first is the identity. */
    virtual std::vector<mrpt::poses::CPose3D> poses() = 0;
};

/** What every baseline is given of a drive. */
struct DriveFacts {
    std::string label;                  //!< of the sensor
    double verticalCorrection_deg = 0;  //!< as io::DriveMeta has it
};

std::unique_ptr<Baseline> makeDelio(const std::string& profile, const DriveFacts& facts);
std::unique_ptr<Baseline> makeCoupledLines(const DriveFacts& facts);
std::unique_ptr<Baseline> makeMrptIcp(const DriveFacts& facts);
std::unique_ptr<Baseline> makePclIcp(const DriveFacts& facts);
std::unique_ptr<Baseline> makePclPlaneIcp(const DriveFacts& facts);
std::unique_ptr<Baseline> makePclGicp(const DriveFacts& facts);
std::unique_ptr<Baseline> makePclNdt(const DriveFacts& facts);

/** Registers each scan against the one before, from the linear prediction on. `Features`: what is
 *  kept of a scan. */
template <typename Features>
class ScanToScan : public Baseline {
 public:
    explicit ScanToScan(const DriveFacts& facts) : prediction_(PredictionOptions()) {
        options_.vertical_correction_deg = facts.verticalCorrection_deg;
    }

    void process(const Scan& scan) final {
        Features features = extract(scan::preprocess(scan, options_));
        if (poses_.empty()) {
            poses_.emplace_back();
        } else {
            const auto increment = align(last_, features, prediction_.predict());
            prediction_.observe(increment);
            poses_.push_back(poses_.back() + increment);
        }
        last_ = std::move(features);
    }
    std::vector<mrpt::poses::CPose3D> poses() final { return poses_; }

 protected:
    virtual Features extract(const scan::PointCloud& cloud) = 0;
    /** Maps the frame of `to` to that of `from`; `guess` where that fails. */
    virtual mrpt::poses::CPose3D align(const Features& from, const Features& to,
                                       const mrpt::poses::CPose3D& guess) = 0;

 private:
    scan::PreprocessOptions options_;
    LinearPrediction prediction_;
    Features last_;
    std::vector<mrpt::poses::CPose3D> poses_;
};
}  // namespace delio::benchmark
