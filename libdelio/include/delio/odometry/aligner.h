#pragma once
#include <mrpt/slam/CICP.h>
#include <mrpt/slam/CMetricMapsAlignmentAlgorithm.h>

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "delio/core/odometry_options.h"

namespace delio {
/** Loaded from `section`, and the stages from `section.plane_map`, `section.plane_registration`,
 *  `section.normals`, `section.bilateral_filter` and `section.pattern_registration`, with the keys
 *  that these have in share/config; strictly, as every StageOptions. The defaults are those of the
 *  profile `accurate`, but for a search of 10 m and for planes
 *  of 1 m that may be narrow. */
struct AlignerOptions : public StageOptions {
    double map_spacing = 0.25;
    double scan_spacing = 0.5;
    double min_agreement = 0.25;
    double first_kernel = 1;
    PlaneMapOptions planeMap;            //!< [plane_map]
    PlaneRegistrationOptions planes;     //!< [plane_registration]
    NormalsOptions normals;              //!< [normals]
    BilateralFilterOptions bilateral;    //!< [bilateral_filter]
    PatternRegistrationOptions pattern;  //!< [pattern_registration]

    AlignerOptions() {
        planes.search_radius = 10;
        // Dense clouds have no rows that could be taken for planes.
        planeMap.voxel_size = 1;
        planeMap.levels = 1;
        planeMap.ground_levels = 0;  // which way is up is not known
        planeMap.min_breadth = 0.1;
    }
    /** Of every section: Error names one that does not exist, and as StageOptions. */
    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    /** Every section. */
    void saveToConfigFile(mrpt::config::CConfigFileBase& target,
                          const std::string& section) const override;
    /** Of every stage. */
    void check(const std::string& section) const override;

 protected:
    std::vector<OptionField> fields() const override;

 private:
    using StageOptions::write;  // would leave out the stages
    template <class List, class Options>
    static List stagesOf(Options& options);
};

/** DeLiO's registration of two 3D clouds wherever an MRPT program uses mrpt::slam::CICP: the
 *  rotation from translation-free residuals to the planes of the first map, then the translation
 *  alone. Where the estimate is too far off for that, the rotation starts from the patterns of the
 *  normals, and the translation is searched horizontally within `planes.search_radius`.
 *
 *  Maps: two mrpt::maps::CPointsMap (any class derived from it) of 3D points in metres, seen from
 *  about their origins as a scan is (the patterns' normals are turned towards it); points that are
 *  not finite are passed over. The result is the pose of the second in the first; of the given
 *  estimate the mean is used. The same bytes for any number of threads.
 *
 *  Throws delio::Error, one line that says which map or estimate is wrong and why, where a map is
 *  missing, is no CPointsMap or has no finite point, where the first has no planes (a cloud of a
 *  2D scan has none), the second too few points, the estimate is not finite, where too few points
 *  come to lie on planes of the first, or where two of the options contradict each other. */
class Aligner : public mrpt::slam::CMetricMapsAlignmentAlgorithm {
 public:
    /** Give it (or a CICP::TReturnInfo, or the base) as `outInfo`. `goodness`: inlier ratio of the
     *  points in voxels with a plane, 0 to 1. `quality`: the smallest observability, 0 if a
     *  direction is unconstrained. */
    struct TReturnInfo : public mrpt::slam::CICP::TReturnInfo {
        /** How well the second map's surfaces meet those of the first, 0 to 1, see
         *  odometry::agreement(). */
        double agreement = 0;
        std::size_t matches = 0;  //!< points on planes
        double residual_m = 0;    //!< root mean square of their distances
        /** Unit vectors, in the second map's axes, about which the estimate's rotation was kept. */
        Eigen::Matrix3Xd unobservedRotation;
        /** Unit vectors, in the first map's axes, along which its translation was kept. */
        Eigen::Matrix3Xd unobservedTranslation;
        bool searched = false;  //!< the initial estimate was too far off
    };

    AlignerOptions options;  //!< may be changed between two calls

    Aligner() = default;
    /** With options that are copied. */
    explicit Aligner(const AlignerOptions& o) : options(o) {}

    /** A CPose3DPDFGaussian; its covariance is MRPT's: x y z yaw pitch roll, metres and radians.
     *  An axis that no plane sees has the variance of `planes.prior_sigma` (`_deg`). */
    mrpt::poses::CPose3DPDF::Ptr Align3DPDF(
        const mrpt::maps::CMetricMap* m1, const mrpt::maps::CMetricMap* m2,
        const mrpt::poses::CPose3DPDFGaussian& initialEstimationPDF,
        mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo = std::nullopt) override;

    /** A CPosePDFGaussian: x, y and yaw of what Align3DPDF() finds. */
    mrpt::poses::CPosePDF::Ptr AlignPDF(
        const mrpt::maps::CMetricMap* m1, const mrpt::maps::CMetricMap* m2,
        const mrpt::poses::CPosePDFGaussian& initialEstimationPDF,
        mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo = std::nullopt) override;
};

/** The paper's registration of two scans wherever an MRPT program uses mrpt::slam::CICP: the
 * rotation from the pattern of the normals, then the translation from the lines between the rings
 * of the unrotated second scan.
 *
 *  Maps, estimate and result are those of Aligner. Each map has to be one scan of a spinning sensor
 *  in the sensor's frame; its rings are found from the points. An axis that neither pattern nor
 * lines constrain keeps the estimate. Of the TReturnInfo of CICP, `goodness` is the overlap of the
 * lines, 0 to 1, and `quality` the smallest observability. The same bytes for any number of
 * threads.
 *
 *  Throws delio::Error, one line, where a map is missing, is no CPointsMap or has no finite point,
 *  where the estimate is not finite, and where rotation or translation are not found. */
class PaperAligner : public mrpt::slam::CMetricMapsAlignmentAlgorithm {
 public:
    PaperOdometryOptions options;  //!< may be changed between two calls

    /** With options that are copied: those of a profile are Options::ofProfile("paper").paper. */
    explicit PaperAligner(const PaperOdometryOptions& o) : options(o) {}

    /** A CPose3DPDFGaussian, as Aligner's. */
    mrpt::poses::CPose3DPDF::Ptr Align3DPDF(
        const mrpt::maps::CMetricMap* m1, const mrpt::maps::CMetricMap* m2,
        const mrpt::poses::CPose3DPDFGaussian& initialEstimationPDF,
        mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo = std::nullopt) override;

    /** A CPosePDFGaussian: x, y and yaw of what Align3DPDF() finds. */
    mrpt::poses::CPosePDF::Ptr AlignPDF(
        const mrpt::maps::CMetricMap* m1, const mrpt::maps::CMetricMap* m2,
        const mrpt::poses::CPosePDFGaussian& initialEstimationPDF,
        mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo = std::nullopt) override;
};
}  // namespace delio
