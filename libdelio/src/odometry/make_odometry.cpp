#include "delio/odometry/make_odometry.h"

namespace delio {
namespace {
template <class List, class Options>
List planeStages(Options& o) {
    return {{"scan", &o.scan},
            {"prediction", &o.prediction},
            {"plane_tracker", &o.tracker},
            {"scan_to_map", &o.scanToMap},
            {"point_map", &o.pointMap},
            {"point_registration", &o.points},
            {"plane_map", &o.map},
            {"plane_registration", &o.registration},
            {"moving_objects", &o.dynamics},
            {"segments", &o.segments},
            {"normals", &o.normals},
            {"bilateral_filter", &o.bilateral},
            {"pattern_registration", &o.pattern}};
}

template <class List, class Options>
List paperStages(Options& o) {
    return {{"scan", &o.scan},
            {"normals", &o.normals},
            {"bilateral_filter", &o.bilateral},
            {"outlier_removal", &o.outliers},
            {"mean_shift", &o.meanShift},
            {"pattern_registration", &o.pattern},
            {"rotation_in_place", &o.inPlace},
            {"line_cloud", &o.lines},
            {"line_registration", &o.lineRegistration},
            {"prediction", &o.prediction},
            {"point_check", &o.check},
            {"point_map", &o.pointMap},
            {"point_registration", &o.points}};
}
}  // namespace

std::vector<OptionField> MethodOptions::fields() const {
    return {{"method", &MethodOptions::method,
             "planes: scan against a map of planes; paper: scan against scan, as in the paper",
             std::vector<std::string>{"planes", "paper"}}};
}

StageList stagesOf(PlaneOdometryOptions& options) { return planeStages<StageList>(options); }
StageList stagesOf(PaperOdometryOptions& options) { return paperStages<StageList>(options); }

ConstStageList stagesOf(const OdometryOptions& options) {
    ConstStageList stages{{"odometry", &options.method}};
    const auto own = options.isPaper() ? paperStages<ConstStageList>(options.paper)
                                       : planeStages<ConstStageList>(options.planes);
    stages.insert(stages.end(), own.begin(), own.end());
    return stages;
}

std::unique_ptr<Odometry> makeOdometry(const OdometryOptions& options) {
    for (const auto& [section, stage] : stagesOf(options)) stage->check(section);
    if (options.isPaper()) return std::make_unique<PaperOdometry>(options.paper);
    return std::make_unique<PlaneOdometry>(options.planes);
}
}  // namespace delio
