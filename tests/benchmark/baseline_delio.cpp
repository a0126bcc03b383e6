#include "baseline.h"
#include "coupled_registration.h"
#include "delio/core/geometry.h"
#include "delio/slam/listeners.h"
#include "delio/slam/options.h"
#include "delio/slam/slam.h"
#include "odometry/rings.h"

namespace delio::benchmark {
namespace {
/** DeLiO as delio-slam --no-map runs it. */
class Delio : public Baseline {
 public:
    explicit Delio(const Options& options)
        : slam_(makeOdometry(options)), graph_(std::make_shared<GraphBuilder>(options.graph)) {
        slam_.attach(graph_);
    }

    void process(const Scan& scan) override {
        slam_.process(scan);
        sensorPoses_.push_back(scan.sensorPose);
    }
    std::vector<Eigen::Isometry3d> poses() override {
        graph_->optimise();
        auto poses = graph_->graph().poses();
        for (std::size_t i = 0; i < poses.size(); ++i)
            poses[i] = sensorPoses_[0].inverse() * poses[i] * sensorPoses_[i];
        return poses;
    }

 private:
    Slam slam_;
    std::shared_ptr<GraphBuilder> graph_;
    std::vector<Eigen::Isometry3d> sensorPoses_;
};

/** Rotation and translation together from line clouds, as Velas et al., with the lines of profile
 *  paper. Of the first pair the motion is searched for, as DeLiO does: without it, line clouds do
 *  not find a vehicle that is moving already. */
class CoupledLines : public ScanToScan<paper::LineCloud> {
 public:
    CoupledLines(const DriveFacts& facts, const PaperOdometryOptions& options)
        : ScanToScan(facts), draw_(options.lines), registration_(options.lineRegistration) {}

 protected:
    paper::LineCloud extract(const odometry::PointCloud& cloud) override {
        ++draw_.seed;  // the same draw twice would pair lines with themselves
        return paper::drawLines(cloud.points, odometry::neighbouringRings(cloud), draw_);
    }
    Eigen::Isometry3d align(const paper::LineCloud& from, const paper::LineCloud& to,
                            const Eigen::Isometry3d& guess) override {
        Eigen::Isometry3d start = guess;
        if (first_)
            start.translation() =
                paper::searchTranslation(from, to, guess.translation(), registration_.search_radius,
                                         registration_)
                    .translation;
        first_ = false;
        return paper::registerCoupled(from, to, start, registration_).pose;
    }

 private:
    LineCloudOptions draw_;
    LineRegistrationOptions registration_;
    bool first_ = true;
};
}  // namespace

std::unique_ptr<Baseline> makeDelio(const std::string& profile, const DriveFacts& facts) {
    auto options = Options::ofProfile(profile);
    options.planes.scan.vertical_correction_deg = facts.verticalCorrection_deg;
    options.paper.scan.vertical_correction_deg = facts.verticalCorrection_deg;
    return std::make_unique<Delio>(options);
}

std::unique_ptr<Baseline> makeCoupledLines(const DriveFacts& facts) {
    return std::make_unique<CoupledLines>(facts, Options::ofProfile("paper").paper);
}
}  // namespace delio::benchmark
