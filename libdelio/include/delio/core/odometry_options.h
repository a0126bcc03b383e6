#pragma once
#include <string>
#include <utility>
#include <vector>

#include "delio/core/stage_options.h"

namespace delio {
/** Preprocessing of a scan. */
struct PreprocessOptions : public StageOptions {
    double min_range = 2.5;
    double max_range = 100;
    double vertical_correction_deg = 0;
    bool deskew = true;
    double sweep_s = 0;

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Motion model. */
struct PredictionOptions : public StageOptions {
    unsigned frames = 3;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Decisions of PlaneOdometry. */
struct PlaneTrackerOptions : public StageOptions {
    double scale = 0;
    double lost_share = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Points kept in the map. */
struct PointMapOptions : public StageOptions {
    double voxel_size = 1.0;
    double spacing = 0.2;
    double radius = 120;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Registration of a scan to the point map. */
struct PointRegistrationOptions : public StageOptions {
    double last_kernel = 0.2;
    unsigned min_matches = 50;

    // Not read from .ini files:
    double first_kernel = 2.0;      //!< m; widest kernel, where the motion is not known
    double least_kernel = 0.3;      //!< m; narrowest first kernel, where it is known
    unsigned max_iterations = 100;  //!< with one kernel
    double converged_m = 5e-3;      //!< a smaller step ends the iteration
    double min_share = 0.1;         //!< inlier ratio of a valid registration

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Planes of the plane map. */
struct PlaneMapOptions : public StageOptions {
    double voxel_size = 0.5;
    unsigned levels = 2;
    unsigned ground_levels = 3;
    unsigned min_points = 8;
    double max_flatness = 0.05;
    double min_breadth = 0.25;
    unsigned max_points = 300;
    double radius = 120;

    // Not read from .ini files:
    double max_thickness = 0.1;  //!< m; standard deviation of a plane's points across it

 protected:
    std::vector<OptionField> fields() const override;
};

/** Registration of a scan to the plane map. */
struct PlaneRegistrationOptions : public StageOptions {
    double last_kernel = 0.1;
    unsigned min_matches = 100;
    double prior_sigma = 0.5;
    double prior_sigma_deg = 1.0;
    double search_radius = 30;
    double search_step = 1;

    // Not read from .ini files:
    unsigned max_iterations = 60;  //!< with one kernel
    double converged_m = 5e-4;     //!< smaller translation steps end the iteration

 protected:
    std::vector<OptionField> fields() const override;
};

/** Detection of dynamic objects. */
struct DynamicObjectsOptions : public StageOptions {
    bool enabled = true;
    double cell_deg = 0.5;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section III-A of the paper leaves the neighbourhood open. Taken from the raw scan, the nearest
 *  neighbours of a near point lie within its range noise, and those of a far one on one ring; the
 *  cloud is therefore thinned to one point per voxel first, and neighbourhoods that are a line (one
 *  ring) or no plane at all are dropped. */
struct NormalsOptions : public StageOptions {
    double voxel_size = 0.4;
    unsigned neighbours = 10;
    double max_radius = 1.5;
    double min_breadth = 0.1;

    // Not read from .ini files:
    double max_thickness =
        0.15;  //!< largest thickness/breadth of a neighbourhood; more is no plane

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section III-A: "bilateral filtering on the surface normals is applied". The paper gives no
 *  numbers. */
struct BilateralFilterOptions : public StageOptions {
    unsigned neighbours = 6;
    double angle_sigma_deg = 10;

    // Not read from .ini files:
    double distance_sigma = 0.5;  //!< m; width of the kernel over distance in space

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section III-B: removal of scattered normals, "iteratively, considering various numbers of
 *  neighbours, to retain a small but stable set". The paper gives no numbers. The set is small when
 *  `small_share` of the normals is left, and stable when a round removes less than `stable_share`
 * of it; either ends the rounds. 0: the rounds end by their number. */
struct OutlierRemovalOptions : public StageOptions {
    unsigned rounds = 3;
    unsigned first_neighbours = 40;
    unsigned last_neighbours = 10;
    double alpha = 2.0;
    bool both_ends = false;
    double small_share = 0;
    double stable_share = 0;

    /** Neighbours on the sphere that round `round` (from 0) looks at. */
    double neighboursOf(unsigned round) const;
    /** The same removal, ended after `count` rounds. */
    OutlierRemovalOptions firstRounds(unsigned count) const;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section III-C: where too little of the pattern is left, the modes of the normals' density are
 *  sought, so that small structures are kept beside the ground. The paper gives no numbers. */
struct MeanShiftOptions : public StageOptions {
    unsigned min_pattern = 500;
    double window_deg = 20;
    unsigned max_iterations = 50;
    unsigned min_support = 10;
    double cell_deg = 1;

    // Not read from .ini files:
    double min_observability = 0.01;  //!< 0 to 1; modes are sought where an axis is fixed less
    double seed_spacing_deg = 10;     //!< deg; between the seeds on the sphere
    double converged_deg = 0.01;      //!< deg; a smaller shift ends the iteration
    double merge_deg = 5;             //!< deg; nearer modes are one
    double ball_deg = 6;              //!< deg; normals so near to a mode are kept

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section III-D. With `kernel_deg` = 0 each normal is paired with its nearest neighbour on the
 *  sphere, as the paper says; inside a dense blob every normal then finds a partner beside itself,
 *  which pulls towards the start. With a kernel, the densities of the two patterns are correlated
 *  instead: each normal is paired with all normals of the other pattern, weighted by a Gaussian of
 *  the angle between them that narrows from `kernel_deg` to `last_kernel_deg`. The part of the
 *  ground that a scan sees moves along with the vehicle: `ground_weight` below 1 leaves roll and
 *  pitch to walls, where there are any. */
struct PatternRegistrationOptions : public StageOptions {
    double kernel_deg = 8;
    double last_kernel_deg = 0.7;
    double cell_deg = 0.5;
    unsigned max_iterations = 60;
    double ground_weight = 1;
    double max_correction_deg = 30;
    double prior_sigma_deg = 1.0;

    // Not read from .ini files:
    double ground_deg = 25;           //!< deg; normals so near to the spin axis are ground
    double converged_deg = 0.001;     //!< deg; a smaller step ends the iteration
    unsigned min_normals = 50;        //!< that are needed; fewer: predicted
    double min_observability = 0.01;  //!< 0 to 1; an axis seen less is unobserved
    double independent_share = 0.05;  //!< of the normals, that count as independent
    double view_distance = 2;         //!< m; the covariance grows by (1 + d / this)^2

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section III-D pairs normals by their direction alone. What a scan sees of the ground moves along
 *  with the vehicle, and with few rings so do the bushes' normals: their pattern stands still while
 *  the vehicle turns. Once a translation is known too, each normal is paired with those of the
 *  other scan that were found at its place; they are of one surface. A guard of the profile
 *  `paper-extended`: in the paper the rotation is never revised. */
struct RotationInPlaceOptions : public StageOptions {
    unsigned rounds = 0;
    double kernel_deg = 3;
    double last_kernel_deg = 0.7;
    unsigned max_iterations = 30;

    // Not read from .ini files:
    double place_sigma = 0.5;      //!< m; width of the kernel over distance in space
    unsigned min_pairs = 500;      //!< that are needed
    double converged_deg = 0.001;  //!< deg; a smaller step ends the iteration

    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section IV-A with the values of Velas et al. (Collar Line Segments). */
struct LineCloudOptions : public StageOptions {
    unsigned sectors = 36;
    unsigned drawn = 20;
    unsigned kept = 5;
    double max_length = 5;
    unsigned seed = 1;

 protected:
    std::vector<OptionField> fields() const override;
};

/** Section IV-B. Two skew lines see only the part of the translation along their common normal;
 *  with `centroids` = true each step is the difference of the centroids of the closest points, as
 *  the paper writes it, which shrinks the step along directions that few pairs see and so takes
 *  many iterations. Otherwise each step goes straight to where those steps end for the pairs at
 *  hand: the least squares solution over the pairs' common normals; and pairs of nearly parallel
 *  lines are left out. Those have no common normal, so that they would hold the estimate within
 *  their surface too; the rings on the ground look the same wherever the sensor stands, and with
 *  them slow drives stood still. Pairs count by how far the noise of their ends leaves them a
 * common normal (`short_length`). */
struct LineRegistrationOptions : public StageOptions {
    bool centroids = false;
    unsigned max_iterations = 40;
    double converged = 0.001;
    unsigned min_matches = 100;
    double prior_sigma = 0.5;
    double search_radius = 8;
    double search_step = 1;

    // Not read from .ini files:
    double min_angle_deg = 15;        //!< deg; lines at smaller angles count as parallel
    double short_length = 0.12;       //!< m; pairs of much shorter lines hardly count
    double max_distance = 5;          //!< m; midpoints of a pair are at most so far apart
    double min_observability = 0.03;  //!< 0 to 1; an axis seen less is unobserved
    double independent_share = 0.25;  //!< of the pairs, that count as independent in the covariance
    double overlap_distance = 0.5;    //!< m; lines with midpoints so near see the same surface
    double search_speed = 30;         //!< m/s; an unknown motion is searched up to this

 protected:
    std::vector<OptionField> fields() const override;
};

/** When points overrule the lines; a guard of the profile `paper-extended`. */
struct PointCheckOptions : public StageOptions {
    bool enabled = false;
    double tolerance = 0.1;
    double rest = 0.3;
    double reach = 4;

    // Not read from .ini files:
    double tolerance_deg = 0.5;  //!< deg; largest deviation of the rotation
    double map_spacing = 0.1;    //!< m; between points of the scan before
    double point_spacing = 1.0;  //!< m; between points of the scan
    double min_moved = 0.3;      //!< part of the points that a standstill must not explain
    double min_share = 0.15;     //!< inlier ratio of these in the pose found

 protected:
    std::vector<OptionField> fields() const override;
};

/** The options of each stage of PlaneOdometry. */
struct PlaneOdometryOptions {
    PreprocessOptions scan;                 //!< [scan]
    PredictionOptions prediction;           //!< [prediction]
    PlaneTrackerOptions tracker;            //!< [plane_tracker]
    PointMapOptions pointMap;               //!< [point_map]
    PointRegistrationOptions points;        //!< [point_registration]
    PlaneMapOptions map;                    //!< [plane_map]
    PlaneRegistrationOptions registration;  //!< [plane_registration]
    DynamicObjectsOptions dynamics;         //!< [moving_objects]
};

/** The options of each stage of PaperOdometry. */
struct PaperOdometryOptions {
    PreprocessOptions scan;                    //!< [scan]
    NormalsOptions normals;                    //!< [normals]
    BilateralFilterOptions bilateral;          //!< [bilateral_filter]
    OutlierRemovalOptions outliers;            //!< [outlier_removal]
    MeanShiftOptions meanShift;                //!< [mean_shift]
    PatternRegistrationOptions pattern;        //!< [pattern_registration]
    RotationInPlaceOptions inPlace;            //!< [rotation_in_place]
    LineCloudOptions lines;                    //!< [line_cloud]
    LineRegistrationOptions lineRegistration;  //!< [line_registration]
    PredictionOptions prediction;              //!< [prediction]
    PointCheckOptions check;                   //!< [point_check]
    PointMapOptions pointMap;                  //!< [point_map]
    PointRegistrationOptions points;           //!< [point_registration]

    /** A guard that the paper does not have is enabled. */
    bool guarded() const { return inPlace.rounds > 0 || check.enabled; }
};

/** Choice of the odometry. */
struct MethodOptions : public StageOptions {
    std::string method = "planes";

 protected:
    std::vector<OptionField> fields() const override;
};

/** Choice of the odometry, and the options of both. Options of the other one have no effect. */
struct OdometryOptions {
    MethodOptions method;         //!< [odometry]: which of the two
    PlaneOdometryOptions planes;  //!< of the profile `accurate`
    PaperOdometryOptions paper;   //!< of the paper's profiles

    bool isPaper() const { return method.method == "paper"; }  //!< the paper's odometry is chosen
    /** [scan], of the chosen one. */
    const PreprocessOptions& scan() const { return isPaper() ? paper.scan : planes.scan; }
};

/** Mutable sections and their options. */
using StageList = std::vector<std::pair<std::string, StageOptions*>>;
/** Sections and their options. */
using ConstStageList = std::vector<std::pair<std::string, const StageOptions*>>;

/** The stages of a method with the names of their sections, in the order in which a scan goes
 *  through them. */
StageList stagesOf(PlaneOdometryOptions& options);
/** The same of the paper's method. */
StageList stagesOf(PaperOdometryOptions& options);
/** Those of the chosen one, the choice first. */
ConstStageList stagesOf(const OdometryOptions& options);
}  // namespace delio
