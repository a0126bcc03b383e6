#pragma once
#include "delio/movers/dynamic_objects.h"
#include "delio/odometry/prediction.h"
#include "delio/odometry/scan_to_map.h"
#include "delio/paper/pattern_registration.h"
#include "delio/scan/preprocess.h"
#include "delio/surfaces/bilateral_filter.h"
#include "delio/surfaces/normals.h"

namespace delio {
struct PlaneTrackerOptions : public StageOptions {
    double map_spacing = 0.25;
    double scan_spacing = 0.5;
    double point_spacing = 1.0;
    double first_speed = 40;
    double acceleration = 15;
    double doubt_spacing = 10;
    double scale = 0;
    double lost_share = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** The options of each stage of PlaneOdometry. */
struct PlaneOdometryOptions {
    scan::PreprocessOptions scan;
    PredictionOptions prediction;
    PlaneTrackerOptions tracker;
    ScanToMapOptions scanToMap;
    points::PointMapOptions pointMap;
    points::PointRegistrationOptions points;
    planes::PlaneMapOptions map;
    planes::PlaneRegistrationOptions registration;
    movers::DynamicObjectsOptions dynamics;
    movers::SegmentOptions segments;
    /** Of the surfaces by which a scan is relocalised. */
    surfaces::NormalsOptions normals;
    surfaces::BilateralFilterOptions bilateral;
    paper::PatternRegistrationOptions pattern;
};
}  // namespace delio
