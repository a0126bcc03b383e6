#include "baseline.h"
#include "delio/slam/options.h"
#include "delio/slam/slam.h"
#include "delio/paper/coupled_registration.h"

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

/** Rotation and translation together from line clouds, as Velas et al., with the lines of profile
 *  paper. Of the first pair the motion is searched for, as DeLiO does: without it, line clouds do
 *  not find a vehicle that is moving already. */
class CoupledLines : public ScanToScan<paper::LineCloud> {
 public:
    CoupledLines(const DriveFacts& facts, const OdometryOptions& options)
        : ScanToScan(facts), draw_(options.lines), registration_(options.lineRegistration) {}

 protected:
    paper::LineCloud extract(const scan::PointCloud& cloud) override {
        ++draw_.seed;  // the same draw twice would pair lines with themselves
        return paper::drawLines(cloud.points, cloud.rings, draw_);
    }
    CPose3D align(const paper::LineCloud& from, const paper::LineCloud& to,
                  const CPose3D& guess) override {
        Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
        start.linear() = guess.getRotationMatrix().asEigen();
        const Eigen::Vector3d t(guess.x(), guess.y(), guess.z());
        start.translation() = first_ ? paper::searchTranslation(
                                           from, to, t, registration_.search_radius, registration_)
                                           .translation
                                     : t;
        first_ = false;
        const auto found = paper::registerCoupled(from, to, start, registration_);
        return {Eigen::Matrix3d(found.pose.linear()), Eigen::Vector3d(found.pose.translation())};
    }

 private:
    paper::LineCloudOptions draw_;
    paper::LineRegistrationOptions registration_;
    bool first_ = true;
};
}  // namespace

std::unique_ptr<Baseline> makeDelio(const std::string& profile, const DriveFacts& facts) {
    auto options = Options::ofProfile(profile);
    options.odometry.preprocess.vertical_correction_deg = facts.verticalCorrection_deg;
    return std::make_unique<Delio>(options, facts.label);
}

std::unique_ptr<Baseline> makeCoupledLines(const DriveFacts& facts) {
    return std::make_unique<CoupledLines>(facts, Options::ofProfile("paper").odometry);
}
}  // namespace delio::benchmark
