#include "delio/core/odometry_options.h"

#include <algorithm>
#include <cmath>

namespace delio {
std::vector<OptionField> PreprocessOptions::fields() const {
    return {{"min_range", &PreprocessOptions::min_range,
             "m; nearer points are dropped (the vehicle itself)", 0, 1e3},
            {"max_range", &PreprocessOptions::max_range, "m; farther points are dropped", 1, 1e4},
            {"vertical_correction_deg", &PreprocessOptions::vertical_correction_deg,
             "deg added to each point's vertical angle; where absent: what DRIVE.meta.yaml says",
             -5, 5},
            {"deskew", &PreprocessOptions::deskew,
             "true: points are brought to the stamp of their scan, where their times are known; "
             "where absent: not if DRIVE.meta.yaml says that they are there already"},
            {"sweep_s", &PreprocessOptions::sweep_s,
             "s; time of a turn, by which points that come without times get them from their "
             "azimuth (clockwise, stamped at the front); 0: such points stay as they are",
             0, 10}};
}

void PreprocessOptions::check(const std::string& section) const {
    requireOrder(section + ".min_range", min_range, section + ".max_range", max_range);
}

std::vector<OptionField> PredictionOptions::fields() const {
    return {{"frames", &PredictionOptions::frames, "N: increments that the prediction is made of",
             1, 100}};
}

std::vector<OptionField> PlaneTrackerOptions::fields() const {
    using Me = PlaneTrackerOptions;
    return {
        {"map_spacing", &Me::map_spacing,
         "m; points of a scan that go into the map are so far apart", 0.01, 10},
        {"scan_spacing", &Me::scan_spacing,
         "m; points that are registered against planes are so far apart", 0.01, 10},
        {"point_spacing", &Me::point_spacing,
         "m; points that are registered against points are so far apart", 0.01, 10},
        {"first_speed", &Me::first_speed,
         "m/s; a motion of which nothing is known is looked for up to this", 0, 1000},
        {"acceleration", &Me::acceleration, "m/s2; of the hardest start or stop", 0, 1000},
        {"doubt_spacing", &Me::doubt_spacing,
         "m; scans that are weakly observed go into the map in such steps, not each", 0, 1000},
        {"scale", &Me::scale,
         "size of the place, by which all lengths that depend on it are multiplied: 1 for "
         "streets, less for rooms; 0: from the scan",
         0, 1},
        {"lost_share", &Me::lost_share,
         "share of the usual share of points on those of the map; with less it is searched for by "
         "surfaces, too",
         0, 1}};
}

std::vector<OptionField> ScanToMapOptions::fields() const {
    using Me = ScanToMapOptions;
    return {{"point_sigma", &Me::point_sigma, "m; error of a scan placed by points along each axis",
             1e-6, 100},
            {"point_sigma_deg", &Me::point_sigma_deg,
             "deg; the same about each axis but the one that the sensor spins about", 1e-6, 180},
            {"believed", &Me::believed,
             "m; planes that lead farther than this from where points place the scan are not "
             "believed",
             0, 10},
            {"believed_deg", &Me::believed_deg, "deg; the same of the rotation", 0, 90},
            {"probe", &Me::probe,
             "m; points see an axis if they bring the scan back that was moved along it by this",
             0.05, 10}};
}

std::vector<OptionField> PointMapOptions::fields() const {
    using Me = PointMapOptions;
    return {{"voxel_size", &Me::voxel_size,
             "m; edge of the voxels, and the farthest that a pair is apart", 0.05, 20},
            {"spacing", &Me::spacing, "m; points of one voxel are at least so far apart", 0.01, 10},
            {"radius", &Me::radius, "m; the map ends at this distance from the sensor", 1, 1e4}};
}

std::vector<OptionField> PointRegistrationOptions::fields() const {
    using Me = PointRegistrationOptions;
    return {{"first_kernel", &Me::first_kernel,
             "m; widest kernel of the distances, where the motion is not known", 1e-3, 100},
            {"least_kernel", &Me::least_kernel,
             "m; else it begins with what the motion model is off, but no narrower than this", 1e-3,
             100},
            {"last_kernel", &Me::last_kernel, "m; width to which the kernel is halved", 1e-3, 100},
            {"max_iterations", &Me::max_iterations, "pairings with one kernel at most", 1, 10000},
            {"converged_m", &Me::converged_m, "m; a smaller step ends the iteration", 0, 1},
            {"min_matches", &Me::min_matches, "pairs that are needed; fewer: predicted", 3, 1e6},
            {"min_share", &Me::min_share,
             "share of a scan's points that have to lie on points of the map; with less it is lost",
             0, 1}};
}

void PointRegistrationOptions::check(const std::string& section) const {
    requireOrder(section + ".last_kernel", last_kernel, section + ".least_kernel", least_kernel);
    requireOrder(section + ".least_kernel", least_kernel, section + ".first_kernel", first_kernel);
}

std::vector<OptionField> PlaneMapOptions::fields() const {
    return {{"voxel_size", &PlaneMapOptions::voxel_size,
             "m; edge of the smallest voxels that hold a plane each", 0.05, 20},
            {"levels", &PlaneMapOptions::levels,
             "of voxels, each twice as large: where the smaller one holds no plane, the larger may",
             1, 6},
            {"ground_levels", &PlaneMapOptions::ground_levels,
             "more of them, again twice as large each, whose planes have to be level", 0, 6},
            {"min_points", &PlaneMapOptions::min_points, "points that a plane needs", 3, 1e6},
            {"max_thickness", &PlaneMapOptions::max_thickness,
             "m; standard deviation of a plane's points across it", 1e-4, 10},
            {"max_flatness", &PlaneMapOptions::max_flatness,
             "largest share of the smallest variance in the middle one; more is no plane", 0, 1},
            {"min_breadth", &PlaneMapOptions::min_breadth,
             "voxel edges; standard deviation of a plane's points along its shorter side: rows of "
             "one ring are no plane, whose normal is known (a voxel's full side has 0.29)",
             0, 0.28},
            {"max_points", &PlaneMapOptions::max_points, "points after which a voxel takes no more",
             3, 1e9},
            {"radius", &PlaneMapOptions::radius, "m; the map ends at this distance from the sensor",
             1, 1e4}};
}

std::vector<OptionField> PlaneRegistrationOptions::fields() const {
    return {
        {"last_kernel", &PlaneRegistrationOptions::last_kernel,
         "m; width to which the kernel is halved", 1e-3, 100},
        {"point_sigma", &PlaneRegistrationOptions::point_sigma, "m; a point's own error", 0, 1},
        {"max_iterations", &PlaneRegistrationOptions::max_iterations,
         "matchings with one kernel at most", 1, 10000},
        {"converged_rad", &PlaneRegistrationOptions::converged_rad, "rad; smaller turns and", 0, 1},
        {"converged_m", &PlaneRegistrationOptions::converged_m,
         "m; smaller moves end the iteration", 0, 1},
        {"min_matches", &PlaneRegistrationOptions::min_matches,
         "points on planes that are needed; fewer: predicted", 6, 1e6},
        {"independent_share", &PlaneRegistrationOptions::independent_share,
         "share of the points that count as independent in the covariance", 1e-6, 1},
        {"prior_sigma", &PlaneRegistrationOptions::prior_sigma,
         "m; the motion model's error along each axis in 0.1 s; in more time more", 1e-6, 100},
        {"prior_sigma_deg", &PlaneRegistrationOptions::prior_sigma_deg,
         "deg; the same about each axis", 1e-6, 180},
        {"search_speed", &PlaneRegistrationOptions::search_speed,
         "m/s; where the motion is not known, what can be driven at this speed is searched", 0,
         1000},
        {"search_radius", &PlaneRegistrationOptions::search_radius, "m; but no farther than this",
         0, 100},
        {"search_step", &PlaneRegistrationOptions::search_step,
         "m; distance between the starts of that search", 0.5, 50}};
}

std::vector<OptionField> DynamicObjectsOptions::fields() const {
    return {{"enabled", &DynamicObjectsOptions::enabled,
             "true: what moves is kept out of registration and map"},
            {"cell_deg", &DynamicObjectsOptions::cell_deg, "deg; directions are told apart by this",
             0.2, 10},
            {"margin", &DynamicObjectsOptions::margin,
             "m; a beam that went on by this saw a place free", 0, 10},
            {"interval_s", &DynamicObjectsOptions::interval_s,
             "s; between the earlier scans that are looked at", 0.05, 100},
            {"memory_s", &DynamicObjectsOptions::memory_s, "s; the earliest of them", 0, 5},
            {"min_share", &DynamicObjectsOptions::min_share,
             "of a segment's points in places of which something is known, those seen free", 0, 1},
            {"min_known", &DynamicObjectsOptions::min_known,
             "share of its points of whose places something is known", 0, 1}};
}

std::vector<OptionField> SegmentOptions::fields() const {
    return {
        {"cell", &SegmentOptions::cell, "m; points of cells that touch belong together", 0.1, 10},
        {"radius", &SegmentOptions::radius, "m; farther from the sensor nothing is looked for", 1,
         100},
        {"above_ground", &SegmentOptions::above_ground, "m; what is lower is ground", 0, 10},
        {"height", &SegmentOptions::height, "m; what is higher is no road user", 0.1, 20},
        {"max_length", &SegmentOptions::max_length, "m; what is longer is no road user", 0.1, 100},
        {"min_points", &SegmentOptions::min_points, "points that a road user has at least", 1,
         1e6}};
}

std::vector<OptionField> NormalsOptions::fields() const {
    return {
        {"voxel_size", &NormalsOptions::voxel_size,
         "m; the cloud is thinned to one point a voxel first", 0.01, 10},
        {"neighbours", &NormalsOptions::neighbours, "nearest neighbours that a normal is made of",
         5, 1000},
        {"max_radius", &NormalsOptions::max_radius, "m; neighbours farther than this are not used",
         0.01, 100},
        {"min_breadth", &NormalsOptions::min_breadth,
         "smallest breadth/length of a neighbourhood; less is a line (one ring), no surface", 0, 1},
        {"max_thickness", &NormalsOptions::max_thickness,
         "largest thickness/breadth of a neighbourhood; more is no plane", 0, 1}};
}

std::vector<OptionField> BilateralFilterOptions::fields() const {
    return {{"neighbours", &BilateralFilterOptions::neighbours,
             "nearest normals that one is averaged over; 0: no filter", 0, 1000},
            {"distance_sigma", &BilateralFilterOptions::distance_sigma,
             "m; width of the kernel over distance in space", 0.001, 100},
            {"angle_sigma_deg", &BilateralFilterOptions::angle_sigma_deg,
             "deg; width of the kernel over the angle", 0.01, 180}};
}

std::vector<OptionField> OutlierRemovalOptions::fields() const {
    return {{"rounds", &OutlierRemovalOptions::rounds,
             "times that outliers are looked for; 0: not at all", 0, 100},
            {"first_neighbours", &OutlierRemovalOptions::first_neighbours,
             "neighbours on the sphere in the first round", 1, 1e4},
            {"last_neighbours", &OutlierRemovalOptions::last_neighbours,
             "neighbours on the sphere in the last round", 1, 1e4},
            {"alpha", &OutlierRemovalOptions::alpha,
             "standard deviations above the mean that still belong", 0, 100}};
}

std::vector<OptionField> MeanShiftOptions::fields() const {
    return {{"min_pattern", &MeanShiftOptions::min_pattern,
             "normals that outlier removal has to leave; fewer: modes are sought", 0, 1e6},
            {"min_observability", &MeanShiftOptions::min_observability,
             "0 to 1; modes are also sought where what is left fixes an axis less than this", 0, 1},
            {"seed_spacing_deg", &MeanShiftOptions::seed_spacing_deg,
             "deg; distance of the seeds on the sphere", 1, 90},
            {"window_deg", &MeanShiftOptions::window_deg, "deg; apex angle of the conical window",
             1, 180},
            {"max_iterations", &MeanShiftOptions::max_iterations, "steps from a seed at most", 1,
             10000},
            {"converged_deg", &MeanShiftOptions::converged_deg,
             "deg; a smaller step ends the iteration", 0, 10},
            {"merge_deg", &MeanShiftOptions::merge_deg, "deg; modes nearer to each other are one",
             0, 90},
            {"min_support", &MeanShiftOptions::min_support,
             "normals that a mode's window has to hold", 1, 1e6},
            {"ball_deg", &MeanShiftOptions::ball_deg, "deg; normals this near to a mode are taken",
             0.1, 90},
            {"cell_deg", &MeanShiftOptions::cell_deg,
             "deg; of which one direction a cell of the sphere is kept", 0.01, 30}};
}

std::vector<OptionField> PatternRegistrationOptions::fields() const {
    return {
        {"kernel_deg", &PatternRegistrationOptions::kernel_deg,
         "deg; first width of the kernel that correlates the densities; 0: nearest neighbours", 0,
         90},
        {"last_kernel_deg", &PatternRegistrationOptions::last_kernel_deg,
         "deg; width to which the kernel is halved", 0.01, 90},
        {"cell_deg", &PatternRegistrationOptions::cell_deg,
         "deg; normals in one cell of the sphere are merged (kernel only)", 0.01, 30},
        {"max_iterations", &PatternRegistrationOptions::max_iterations, "pairings at most", 1,
         10000},
        {"converged_deg", &PatternRegistrationOptions::converged_deg,
         "deg; a smaller step ends the iteration", 0, 10},
        {"min_normals", &PatternRegistrationOptions::min_normals,
         "normals that each pattern needs; fewer: predicted", 3, 1e6},
        {"min_observability", &PatternRegistrationOptions::min_observability,
         "0 to 1; an axis that the pattern fixes less keeps the prediction", 0, 1},
        {"max_correction_deg", &PatternRegistrationOptions::max_correction_deg,
         "deg; a rotation farther than this from the prediction is not believed", 0.1, 180},
        {"independent_share", &PatternRegistrationOptions::independent_share,
         "share of the normals that count as independent in the covariance: neighbours share "
         "points",
         1e-6, 1},
        {"view_distance", &PatternRegistrationOptions::view_distance,
         "m; this far from each other two scans see so different parts of the surfaces that the "
         "standard deviation has doubled",
         0.01, 1e9},
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
            {"place_sigma", &RotationInPlaceOptions::place_sigma,
             "m; width of the kernel over the distance of two normals' places", 0.01, 100},
            {"kernel_deg", &RotationInPlaceOptions::kernel_deg,
             "deg; first width of the kernel over the angle of two normals", 0.01, 90},
            {"last_kernel_deg", &RotationInPlaceOptions::last_kernel_deg,
             "deg; width to which that kernel is halved", 0.01, 90},
            {"min_pairs", &RotationInPlaceOptions::min_pairs,
             "pairs that are needed; fewer: the pattern's rotation stays", 3, 1e6},
            {"max_iterations", &RotationInPlaceOptions::max_iterations,
             "weightings of the pairs at most", 1, 10000},
            {"converged_deg", &RotationInPlaceOptions::converged_deg,
             "deg; a smaller step ends the iteration", 0, 10}};
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
        {"min_angle_deg", &LineRegistrationOptions::min_angle_deg,
         "deg; lines at a smaller angle count as parallel", 0.01, 90},
        {"short_length", &LineRegistrationOptions::short_length,
         "m; pairs of lines much shorter than this (centroids = false) hardly count: noise turns "
         "their common normal",
         0, 10},
        {"max_distance", &LineRegistrationOptions::max_distance,
         "m; midpoints farther apart are never a pair", 0.01, 1000},
        {"max_iterations", &LineRegistrationOptions::max_iterations, "pairings at most", 1, 10000},
        {"converged", &LineRegistrationOptions::converged, "m; a smaller step ends the iteration",
         0, 10},
        {"min_matches", &LineRegistrationOptions::min_matches,
         "pairs that are needed; fewer: predicted", 3, 1e6},
        {"min_observability", &LineRegistrationOptions::min_observability,
         "0 to 1; a direction that the lines fix less keeps the prediction", 0, 1},
        {"independent_share", &LineRegistrationOptions::independent_share,
         "share of the pairs that count as independent in the covariance: lines share surfaces",
         1e-6, 1},
        {"overlap_distance", &LineRegistrationOptions::overlap_distance,
         "m; lines whose midpoints are nearer to each other lie on a surface that both scans see",
         0, 100},
        {"prior_sigma", &LineRegistrationOptions::prior_sigma,
         "m; the motion model's error along such a direction in 0.1 s; in more time more", 1e-6,
         100},
        {"search_speed", &LineRegistrationOptions::search_speed,
         "m/s; where the motion is not known, what can be driven at this speed is searched", 0,
         1000},
        {"search_radius", &LineRegistrationOptions::search_radius, "m; but no farther than this", 0,
         50},
        {"search_step", &LineRegistrationOptions::search_step, "m; distance between those starts",
         0.1, 50}};
}

std::vector<OptionField> PointCheckOptions::fields() const {
    using Me = PointCheckOptions;
    return {
        {"enabled", &Me::enabled, "false: lines and patterns are taken at their word"},
        {"believed", &Me::believed,
         "m; lines that lead farther than this from where points place the scan are not "
         "believed",
         0, 10},
        {"believed_deg", &Me::believed_deg, "deg; the same of the pattern's rotation", 0, 180},
        {"map_spacing", &Me::map_spacing, "m; points of the scan before are so far apart", 0.01,
         10},
        {"point_spacing", &Me::point_spacing, "m; points of the scan are so far apart", 0.01, 10},
        {"rest", &Me::rest,
         "m; points nearer than this to the scan before, were the vehicle at rest, say nothing",
         0.01, 10},
        {"min_moved", &Me::min_moved,
         "share of the points that have to be farther; with fewer they are not asked", 0, 1},
        {"min_share", &Me::min_share,
         "share of those that have to lie on points of the scan before in the place found", 0, 1},
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
             "planes: scan against a map of planes; paper: scan against scan, as in the paper",
             std::vector<std::string>{"planes", "paper"}}};
}

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
