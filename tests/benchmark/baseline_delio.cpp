#include "baseline.h"
#include "delio/profile.h"
#include "delio/slam.h"
#include "delio/translation/coupled_registration.h"

namespace delio::benchmark {
using mrpt::poses::CPose3D;

namespace {
/** DeLiO as delio-slam --no-map runs it. */
class Delio : public Baseline {
 public:
    Delio(const Options& options, const std::string& label) : slam_(options, true, false, label) {}

    void process(const Scan& scan) override {
        slam_.process(scan);
        sensorPoses_.push_back(scan.sensorPose);
    }
    std::vector<CPose3D> poses() override {
        slam_.optimise();
        auto poses = slam_.trajectory().poses;
        for (std::size_t i = 0; i < poses.size(); ++i)
            poses[i] = (-sensorPoses_[0]) + poses[i] + sensorPoses_[i];
        return poses;
    }

 private:
    Slam slam_;
    std::vector<CPose3D> sensorPoses_;
};

/** Rotation and translation together from line clouds, as Velas et al. */
class CoupledLines : public ScanToScan<translation::LineCloud> {
 public:
    using ScanToScan::ScanToScan;

 protected:
    translation::LineCloud extract(const scan::PointCloud& cloud) override {
        ++draw_.seed;  // the same draw twice would pair lines with themselves
        return translation::drawLines(cloud.points, cloud.rings, draw_);
    }
    CPose3D align(const translation::LineCloud& from, const translation::LineCloud& to,
                  const CPose3D& guess) override {
        Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
        start.linear() = guess.getRotationMatrix().asEigen();
        start.translation() << guess.x(), guess.y(), guess.z();
        const auto found = translation::registerCoupled(from, to, start, registration_);
        return {Eigen::Matrix3d(found.pose.linear()), Eigen::Vector3d(found.pose.translation())};
    }

 private:
    translation::LineCloudOptions draw_;
    translation::LineRegistrationOptions registration_;
};
}  // namespace

std::unique_ptr<Baseline> makeDelio(const std::string& profile, const DriveFacts& facts) {
    auto options = Options::ofProfile(profile);
    options.odometry.preprocess.vertical_correction_deg = facts.verticalCorrection_deg;
    return std::make_unique<Delio>(options, facts.label);
}

std::unique_ptr<Baseline> makeCoupledLines(const DriveFacts& facts) {
    return std::make_unique<CoupledLines>(facts);
}
}  // namespace delio::benchmark
