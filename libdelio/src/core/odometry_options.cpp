#include "delio/core/odometry_options.h"

#include <algorithm>
#include <cmath>

namespace delio {
std::vector<OptionField> PreprocessOptions::fields() const {
    return {OptionField{"min_range", &PreprocessOptions::min_range,
                        "m; points closer than this (the vehicle itself) are ignored", 0, 1e3}
                .scaled(),
            {"max_range", &PreprocessOptions::max_range, "m; points farther than this are ignored",
             1, 1e4},
            {"vertical_correction_deg", &PreprocessOptions::vertical_correction_deg,
             "deg; added to each point's vertical angle; if not set: the value in DRIVE.meta.yaml "
             "(method paper: 0)",
             -5, 5},
            {"deskew", &PreprocessOptions::deskew,
             "true: de-skew scans whose points have times; if not set: unless the recording is "
             "de-skewed already"},
            {"sweep_s", &PreprocessOptions::sweep_s,
             "s; duration of a revolution, to derive missing point times from azimuths (clockwise, "
             "stamp at the front); 0: do not derive times",
             0, 10}};
}

void PreprocessOptions::check(const std::string& section) const {
    requireOrder(section + ".min_range", min_range, section + ".max_range", max_range);
}

std::vector<OptionField> PredictionOptions::fields() const {
    return {{"frames", &PredictionOptions::frames,
             "number of increments averaged for the prediction", 1, 100}};
}

std::vector<OptionField> PlaneTrackerOptions::fields() const {
    using Me = PlaneTrackerOptions;
    return {
        {"scale", &Me::scale,
         "scale of the scene, which multiplies all lengths that depend on it: 1 for streets, less "
         "for rooms; 0: measured from the scan",
         0, 1},
        {"lost_share", &Me::lost_share,
         "fraction of the usual inlier ratio below which a scan also searches by surfaces", 0, 1}};
}

std::vector<OptionField> PointMapOptions::fields() const {
    using Me = PointMapOptions;
    return {OptionField{"voxel_size", &Me::voxel_size,
                        "m; voxel size, and maximum distance of a correspondence", 0.05, 20}
                .scaled(),
            OptionField{"spacing", &Me::spacing, "m; minimum distance between points of the map",
                        0.01, 10}
                .scaled(),
            {"radius", &Me::radius, "m; map radius around the sensor", 1, 1e4}};
}

std::vector<OptionField> PointRegistrationOptions::fields() const {
    using Me = PointRegistrationOptions;
    return {OptionField{"last_kernel", &Me::last_kernel, "m; final width of the robust kernel",
                        1e-3, 100}
                .scaled(),
            {"min_matches", &Me::min_matches,
             "minimum number of correspondences; with fewer the scan is predicted", 3, 1e6}};
}

void PointRegistrationOptions::check(const std::string& section) const {
    requireOrder(section + ".last_kernel", last_kernel, section + ".least_kernel", least_kernel);
    requireOrder(section + ".least_kernel", least_kernel, section + ".first_kernel", first_kernel);
}

std::vector<OptionField> PlaneMapOptions::fields() const {
    return {
        OptionField{"voxel_size", &PlaneMapOptions::voxel_size,
                    "m; size of the smallest voxels; each holds one plane", 0.05, 20}
            .scaled(),
        {"levels", &PlaneMapOptions::levels,
         "number of voxel levels, each twice as large as the one before; a larger voxel is used "
         "where the smaller holds no plane",
         1, 6},
        {"ground_levels", &PlaneMapOptions::ground_levels,
         "number of further levels that hold only horizontal planes", 0, 6},
        {"min_points", &PlaneMapOptions::min_points, "minimum number of points of a plane", 3, 1e6},
        {"max_flatness", &PlaneMapOptions::max_flatness,
         "maximum ratio of the smallest to the middle variance of a plane's points", 0, 1},
        {"min_breadth", &PlaneMapOptions::min_breadth,
         "voxel sizes; minimum standard deviation of a plane's points along its shorter side, "
         "which excludes single rings (a full voxel has 0.29)",
         0, 0.28},
        {"max_points", &PlaneMapOptions::max_points, "maximum number of points of a voxel", 3, 1e9},
        {"radius", &PlaneMapOptions::radius, "m; map radius around the sensor", 1, 1e4}};
}

std::vector<OptionField> PlaneRegistrationOptions::fields() const {
    return {
        OptionField{"last_kernel", &PlaneRegistrationOptions::last_kernel,
                    "m; final width of the robust kernel", 1e-3, 100}
            .scaled(),
        {"min_matches", &PlaneRegistrationOptions::min_matches,
         "minimum number of points on planes; with fewer the scan is predicted", 6, 1e6},
        {"prior_sigma", &PlaneRegistrationOptions::prior_sigma,
         "m; standard deviation of the motion model along each axis after 0.1 s; grows with time",
         1e-6, 100},
        {"prior_sigma_deg", &PlaneRegistrationOptions::prior_sigma_deg,
         "deg; standard deviation of the motion model about each axis after 0.1 s; grows with time",
         1e-6, 180},
        {"search_radius", &PlaneRegistrationOptions::search_radius,
         "m; radius of the search by surfaces when the motion is unknown", 0, 100},
        OptionField{"search_step", &PlaneRegistrationOptions::search_step,
                    "m; distance between initial guesses of that search", 0.5, 50}
            .scaled()};
}

std::vector<OptionField> DynamicObjectsOptions::fields() const {
    return {{"enabled", &DynamicObjectsOptions::enabled,
             "true: exclude dynamic objects from registration and map"},
            {"cell_deg", &DynamicObjectsOptions::cell_deg,
             "deg; angular resolution of the range image", 0.2, 10}};
}

std::vector<OptionField> NormalsOptions::fields() const {
    return {{"voxel_size", &NormalsOptions::voxel_size,
             "m; the cloud is thinned to one point per voxel first", 0.01, 10},
            {"neighbours", &NormalsOptions::neighbours,
             "nearest neighbours that a normal is made of", 5, 1000},
            {"max_radius", &NormalsOptions::max_radius,
             "m; neighbours farther than this are not used", 0.01, 100},
            {"min_breadth", &NormalsOptions::min_breadth,
             "smallest breadth/length of a neighbourhood; less is a line (one ring), no surface", 0,
             1}};
}

std::vector<OptionField> BilateralFilterOptions::fields() const {
    return {{"neighbours", &BilateralFilterOptions::neighbours,
             "nearest normals that one is averaged over; 0: no filter", 0, 1000},
            {"angle_sigma_deg", &BilateralFilterOptions::angle_sigma_deg,
             "deg; width of the kernel over the angle", 0.01, 180}};
}

std::vector<OptionField> OutlierRemovalOptions::fields() const {
    return {{"rounds", &OutlierRemovalOptions::rounds,
             "times that outliers are looked for at most; 0: not at all", 0, 100},
            {"first_neighbours", &OutlierRemovalOptions::first_neighbours,
             "neighbours on the sphere in the first round", 1, 1e4},
            {"last_neighbours", &OutlierRemovalOptions::last_neighbours,
             "neighbours on the sphere in the last round", 1, 1e4},
            {"alpha", &OutlierRemovalOptions::alpha,
             "standard deviations above the mean that still belong", 0, 100},
            {"both_ends", &OutlierRemovalOptions::both_ends,
             "true: what is as far below the mean is removed, too"},
            {"small_share", &OutlierRemovalOptions::small_share,
             "0 to 1; fraction of the normals that is a small set and ends the rounds", 0, 1},
            {"stable_share", &OutlierRemovalOptions::stable_share,
             "share of a set: a round that removes less shows that it is stable, and is the last",
             0, 1}};
}

std::vector<OptionField> MeanShiftOptions::fields() const {
    return {{"min_pattern", &MeanShiftOptions::min_pattern,
             "normals that outlier removal has to leave; fewer: modes are sought", 0, 1e6},
            {"window_deg", &MeanShiftOptions::window_deg, "deg; apex angle of the conical window",
             1, 180},
            {"max_iterations", &MeanShiftOptions::max_iterations, "steps from a seed at most", 1,
             10000},
            {"min_support", &MeanShiftOptions::min_support,
             "normals that a mode's window has to hold", 1, 1e6},
            {"cell_deg", &MeanShiftOptions::cell_deg,
             "deg; of which one direction a cell of the sphere is kept", 0.01, 30}};
}

std::vector<OptionField> PatternRegistrationOptions::fields() const {
    return {{"kernel_deg", &PatternRegistrationOptions::kernel_deg,
             "deg; first width of the kernel that correlates the densities; 0: nearest neighbours",
             0, 90},
            {"last_kernel_deg", &PatternRegistrationOptions::last_kernel_deg,
             "deg; width to which the kernel is halved", 0.01, 90},
            {"cell_deg", &PatternRegistrationOptions::cell_deg,
             "deg; normals in one cell of the sphere are merged (kernel only)", 0.01, 30},
            {"max_iterations", &PatternRegistrationOptions::max_iterations, "pairings at most", 1,
             10000},
            {"ground_weight", &PatternRegistrationOptions::ground_weight,
             "weight of normals within 25 deg of the spin axis (ground, roofs) relative to others",
             0.001, 1},
            {"max_correction_deg", &PatternRegistrationOptions::max_correction_deg,
             "deg; a rotation farther than this from the prediction is rejected", 0.1, 180},
            {"prior_sigma_deg", &PatternRegistrationOptions::prior_sigma_deg,
             "deg; the motion model's error on such an axis", 1e-6, 180}};
}

void PatternRegistrationOptions::check(const std::string& section) const {
    if (kernel_deg > 0)  // 0: nearest neighbours
        requireOrder(section + ".last_kernel_deg", last_kernel_deg, section + ".kernel_deg",
                     kernel_deg);
}

std::vector<OptionField> RotationInPlaceOptions::fields() const {
    return {{"rounds", &RotationInPlaceOptions::rounds,
             "times that the rotation is found again from the normals at the same places, and the "
             "translation after it; 0: not at all",
             0, 100},
            {"kernel_deg", &RotationInPlaceOptions::kernel_deg,
             "deg; first width of the kernel over the angle of two normals", 0.01, 90},
            {"last_kernel_deg", &RotationInPlaceOptions::last_kernel_deg,
             "deg; width to which that kernel is halved", 0.01, 90},
            {"max_iterations", &RotationInPlaceOptions::max_iterations,
             "weightings of the pairs at most", 1, 10000}};
}

void RotationInPlaceOptions::check(const std::string& section) const {
    requireOrder(section + ".last_kernel_deg", last_kernel_deg, section + ".kernel_deg",
                 kernel_deg);
}

std::vector<OptionField> LineCloudOptions::fields() const {
    return {
        {"sectors", &LineCloudOptions::sectors, "sectors of azimuth in the polar grid", 1, 3600},
        {"drawn", &LineCloudOptions::drawn, "random lines drawn in each bin", 1, 10000},
        {"kept", &LineCloudOptions::kept, "shortest lines kept of those", 1, 10000},
        {"max_length", &LineCloudOptions::max_length, "m; longer lines are not kept", 0.01, 1000},
        {"seed", &LineCloudOptions::seed,
         "seed of the draw; scan i of a drive is drawn with seed + i", 0, 4294967295.0}};
}

std::vector<OptionField> LineRegistrationOptions::fields() const {
    return {
        {"centroids", &LineRegistrationOptions::centroids,
         "true: each step is the difference of the closest points' centroids; false: where "
         "those steps end"},
        {"max_iterations", &LineRegistrationOptions::max_iterations, "pairings at most", 1, 10000},
        {"converged", &LineRegistrationOptions::converged, "m; a smaller step ends the iteration",
         0, 10},
        {"min_matches", &LineRegistrationOptions::min_matches,
         "pairs that are needed; fewer: predicted", 3, 1e6},
        {"prior_sigma", &LineRegistrationOptions::prior_sigma,
         "m; the motion model's error along such a direction in 0.1 s; in more time more", 1e-6,
         100},
        {"search_radius", &LineRegistrationOptions::search_radius,
         "m; where the motion is not known, surfaces are searched up to this distance", 0, 50},
        {"search_step", &LineRegistrationOptions::search_step, "m; distance between those starts",
         0.1, 50}};
}

std::vector<OptionField> PointCheckOptions::fields() const {
    using Me = PointCheckOptions;
    return {{"enabled", &Me::enabled, "true: points may overrule lines and patterns"},
            {"tolerance", &Me::tolerance,
             "m; a translation by lines farther than this from that by points is rejected", 0, 10},
            {"rest", &Me::rest,
             "m; points nearer than this to the scan before, were the vehicle at rest, say nothing",
             0.01, 10},
            {"reach", &Me::reach, "m; motions are searched up to this", 0, 50}};
}

double OutlierRemovalOptions::neighboursOf(unsigned round) const {
    const double step = rounds > 1 ? static_cast<double>(round) / (rounds - 1) : 0;
    return first_neighbours + step * (static_cast<double>(last_neighbours) - first_neighbours);
}

OutlierRemovalOptions OutlierRemovalOptions::firstRounds(unsigned count) const {
    OutlierRemovalOptions first = *this;
    first.rounds = std::min(count, rounds);
    if (first.rounds > 0)
        first.last_neighbours = static_cast<unsigned>(std::lround(neighboursOf(first.rounds - 1)));
    return first;
}

std::vector<OptionField> MethodOptions::fields() const {
    return {{"method", &MethodOptions::method,
             "planes: register scans to a map of points and planes; paper: register scans to scans "
             "as in the paper",
             std::vector<std::string>{"planes", "paper"}}};
}

namespace {
template <class List, class Options>
List planeStages(Options& o) {
    return {{"scan", &o.scan},
            {"prediction", &o.prediction},
            {"plane_tracker", &o.tracker},
            {"point_map", &o.pointMap},
            {"point_registration", &o.points},
            {"plane_map", &o.map},
            {"plane_registration", &o.registration},
            {"moving_objects", &o.dynamics}};
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

StageList stagesOf(PlaneOdometryOptions& options) { return planeStages<StageList>(options); }
StageList stagesOf(PaperOdometryOptions& options) { return paperStages<StageList>(options); }

ConstStageList stagesOf(const OdometryOptions& options) {
    ConstStageList stages{{"odometry", &options.method}};
    const auto own = options.isPaper() ? paperStages<ConstStageList>(options.paper)
                                       : planeStages<ConstStageList>(options.planes);
    stages.insert(stages.end(), own.begin(), own.end());
    return stages;
}

}  // namespace delio
