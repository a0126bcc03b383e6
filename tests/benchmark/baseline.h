#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "delio/odometry/scan.h"
#include "odometry/motion_model.h"
#include "odometry/preprocess.h"

namespace delio::benchmark {
/** An odometry that is measured beside the others. */
class Baseline {
 public:
    virtual ~Baseline() = default;
    virtual void process(const Scan& scan) = 0;
    /** After the last scan: poses of the sensor, the first is the identity. */
    virtual std::vector<Eigen::Isometry3d> poses() = 0;
};

/** What every baseline is given of a drive. */
struct DriveFacts {
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
        Features features = extract(odometry::preprocess(scan, options_));
        if (poses_.empty()) {
            poses_.push_back(Eigen::Isometry3d::Identity());
        } else {
            const auto increment = align(last_, features, prediction_.predict());
            prediction_.observe(increment);
            poses_.push_back(poses_.back() * increment);
        }
        last_ = std::move(features);
    }
    std::vector<Eigen::Isometry3d> poses() final { return poses_; }

 protected:
    virtual Features extract(const odometry::PointCloud& cloud) = 0;
    /** Maps the frame of `to` to that of `from`; `guess` where that fails. */
    virtual Eigen::Isometry3d align(const Features& from, const Features& to,
                                    const Eigen::Isometry3d& guess) = 0;

 private:
    PreprocessOptions options_;
    odometry::LinearPrediction prediction_;
    Features last_;
    std::vector<Eigen::Isometry3d> poses_;
};
}  // namespace delio::benchmark
