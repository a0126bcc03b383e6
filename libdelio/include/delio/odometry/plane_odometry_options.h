#pragma once
#include "delio/movers/dynamic_objects.h"
#include "delio/odometry/prediction.h"
#include "delio/odometry/scan_to_map.h"
#include "delio/paper/pattern_registration.h"
#include "delio/scan/preprocess.h"
#include "delio/surfaces/bilateral_filter.h"
#include "delio/surfaces/normals.h"

namespace delio {
/** What PlaneOdometry itself decides by. */
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
    scan::PreprocessOptions scan;                   //!< [scan]
    PredictionOptions prediction;                   //!< [prediction]
    PlaneTrackerOptions tracker;                    //!< [plane_tracker]
    ScanToMapOptions scanToMap;                     //!< [scan_to_map]
    points::PointMapOptions pointMap;               //!< [point_map]
    points::PointRegistrationOptions points;        //!< [point_registration]
    planes::PlaneMapOptions map;                    //!< [plane_map]
    planes::PlaneRegistrationOptions registration;  //!< [plane_registration]
    movers::DynamicObjectsOptions dynamics;         //!< [moving_objects]
    movers::SegmentOptions segments;                //!< [segments]
    /** [normals]: of the surfaces by which a scan is relocalised. */
    surfaces::NormalsOptions normals;
    surfaces::BilateralFilterOptions bilateral;  //!< [bilateral_filter], likewise
    paper::PatternRegistrationOptions pattern;   //!< [pattern_registration], likewise
};
}  // namespace delio
