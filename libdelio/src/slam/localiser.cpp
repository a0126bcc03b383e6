#include "delio/slam/localiser.h"

#include "delio/core/error.h"
#include "delio/graph/pose_graph.h"
#include "recordings/decode_observation.h"
#include "slam/place_listeners.h"

namespace delio {
Localiser::Localiser(std::shared_ptr<const StoredMap> map, const OdometryOptions& options,
                     const PlaceSearchOptions& search, const LocalisationOptions& localisation)
    : follower_(std::make_shared<MapFollower>(MapTracker(std::move(map), search, localisation),
                                              History::Last)),
      slam_(makeOdometry(options), History::Last) {
    slam_.attach(follower_);
}

void Localiser::expect(const Eigen::Isometry3d& vehicle) { follower_->expect(vehicle); }

Localisation Localiser::process(const Scan& scan) {
    auto report = slam_.process(scan);
    if (!report.failed.empty()) fault_ = report.failed.front().message;
    if (!fault_.empty()) throw Error("localisation stopped: " + fault_);
    return {std::move(report.step), follower_->fixes().back()};
}

std::optional<mrpt::poses::CPose3DPDFGaussian> Localiser::process(
    const mrpt::obs::CObservation& observation) {
    if (!io::isScan(observation))
        throw Error("an observation of class " +
                    std::string(observation.GetRuntimeClass()->className) + " is not a LiDAR scan");
    Scan scan = io::decodeObservation(observation);
    scan.index = observations_++;
    scan.time = observation.timestamp;
    scan.stamp_s = mrpt::Clock::toDouble(observation.timestamp);
    const auto found = process(scan);
    if (found.fix.where == Whereabouts::kUnknown) return {};
    return graph::posePdfOf(found.fix.vehicle);
}
}  // namespace delio
