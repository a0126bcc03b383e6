#include "delio/odometry/aligner.h"

#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/estimates.h"
#include "core/voxel_grid.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/core/stopwatch.h"
#include "delio/core/text.h"
#include "delio/graph/pose_graph.h"
#include "delio/odometry/odometry.h"
#include "odometry/initial_guess.h"
#include "odometry/paper_odometry.h"
#include "odometry/spin_axis.h"
#include "paper/normals.h"

namespace delio {
using mrpt::maps::CMetricMap;
using mrpt::poses::CPose3DPDFGaussian;
using mrpt::poses::CPosePDFGaussian;
using odometry::PlaneEstimate;
using odometry::PlaneMap;

namespace {
/** The finite points of a map; `which` names it in errors. */
Eigen::Matrix3Xf pointsOf(const CMetricMap* map, const std::string& which) {
    if (!map) throw Error("Aligner: there is no " + which + " map");
    const auto* cloud = dynamic_cast<const mrpt::maps::CPointsMap*>(map);
    if (!cloud)
        throw Error("Aligner: the " + which + " map is a " + map->GetRuntimeClass()->className +
                    "; only maps of points (CPointsMap) can be aligned");
    const auto& x = cloud->getPointsBufferRef_x();
    const auto& y = cloud->getPointsBufferRef_y();
    const auto& z = cloud->getPointsBufferRef_z();
    Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(x.size()));
    Eigen::Index kept = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Eigen::Vector3f point(x[i], y[i], z[i]);
        if (point.allFinite()) points.col(kept++) = point;
    }
    points.conservativeResize(3, kept);
    if (kept == 0) throw Error("Aligner: the " + which + " map has no finite points");
    return points;
}

/** How the map of planes is turned against the first cloud: clouds of buildings tend to have their
 *  walls along their axes. On a border between voxels such a wall would lie over its whole length,
 *  with half of its points on either side, and lose them to a step of a centimetre; it has to
 *  cross the voxels. Nearly upright, for the search is horizontal. */
Eigen::Matrix3d mapTurn() {
    return rotationExp(0.5 * Eigen::Vector3d::UnitZ()) * rotationExp({0.012, 0.016, 0});
}

/** One alignment: properties of both clouds, and the ways to register them. Estimates are
 *  in the turned map; see inFirst(). */
class Alignment {
 public:
    Alignment(const Eigen::Matrix3Xf& from, const Eigen::Matrix3Xf& to,
              const AlignerOptions& options)
        : options_(options),
          from_(from),
          map_(options.planeMap),
          points_(voxelCentroids(to, options.scan_spacing).cast<double>()),
          surfaces_(surfacesOf(to)) {
        map_.add(turn_ * voxelCentroids(from, options.map_spacing).cast<double>());
        if (map_.planes() == 0)
            throw Error("Aligner: the first map has no planes, of " + std::to_string(from.cols()) +
                        " points; it has to be a cloud of surfaces in 3D");
        if (points_.cols() < options.planes.min_matches)
            throw Error(
                "Aligner: the second map has too few points: " + std::to_string(points_.cols()) +
                " that are " + digitsOf(options.scan_spacing) + " m apart, " +
                std::to_string(options.planes.min_matches) + " are needed");
    }

    PlaneEstimate fromEstimate(const Eigen::Isometry3d& guess) const {
        return odometry::registerToPlanes(map_, points_,
                                          odometry::priorOf(inMap(guess), options_.planes),
                                          options_.first_kernel, options_.planes);
    }

    PlaneEstimate searched(const Eigen::Isometry3d& guess) const {
        return odometry::relocalise(map_, surfacesOf(from_), inMap(Eigen::Isometry3d::Identity()),
                                    points_, surfaces_, inMap(guess), options_.planes.search_radius,
                                    options_.planes, options_.pattern);
    }

    double agreementAt(const PlaneEstimate& estimate) const {
        return estimate.valid ? odometry::agreement(map_, surfaces_, estimate.pose(),
                                                    2 * options_.planes.last_kernel)
                              : 0;
    }

    /** The estimate with the first cloud's axes in place of the map's. */
    PlaneEstimate inFirst(PlaneEstimate estimate) const {
        const Eigen::Matrix3d back = turn_.transpose();
        auto& translation = estimate.translation;
        estimate.rotation.rotation = back * estimate.rotation.rotation;
        translation.translation = back * translation.translation;
        translation.covariance = back * translation.covariance * turn_;
        translation.lever = back * translation.lever * turn_;
        translation.unobservedAxes = back * translation.unobservedAxes;
        return estimate;
    }

 private:
    paper::SurfaceNormals surfacesOf(const Eigen::Matrix3Xf& points) const {
        return paper::surfacesOf(points, options_.normals, options_.bilateral);
    }
    Eigen::Isometry3d inMap(const Eigen::Isometry3d& inFirst) const {
        return isometry(turn_ * inFirst.linear(), turn_ * inFirst.translation());
    }

    const AlignerOptions& options_;
    const Eigen::Matrix3Xf& from_;
    const Eigen::Matrix3d turn_ = mapTurn();
    PlaneMap map_;
    Eigen::Matrix3Xd points_;
    paper::SurfaceNormals surfaces_;
};

void tell(const PlaneEstimate& estimate, double agreement, bool searched, double seconds,
          mrpt::slam::TMetricMapAlignmentResult& out) {
    out.executionTime = seconds;
    if (auto* icp = dynamic_cast<mrpt::slam::CICP::TReturnInfo*>(&out)) {
        icp->nIterations = estimate.rotation.iterations;
        icp->goodness = estimate.inlierRatio;
        icp->quality = std::min(estimate.rotation.observability.minCoeff(),
                                estimate.translation.observability.minCoeff());
    }
    if (auto* info = dynamic_cast<Aligner::TReturnInfo*>(&out)) {
        info->agreement = agreement;
        info->matches = estimate.translation.matches;
        info->residual_m = estimate.translation.residual_m;
        info->unobservedRotation = estimate.rotation.unobservedAxes;
        info->unobservedTranslation = estimate.translation.unobservedAxes;
        info->searched = searched;
    }
}
}  // namespace

std::vector<OptionField> AlignerOptions::fields() const {
    return {{"map_spacing", &AlignerOptions::map_spacing,
             "m; points that planes are made of are so far apart", 0.01, 10},
            {"scan_spacing", &AlignerOptions::scan_spacing,
             "m; points that are registered are so far apart", 0.01, 10},
            {"min_agreement", &AlignerOptions::min_agreement,
             "0 to 1; agreement of the surfaces that ends it without a search", 0, 1},
            {"first_kernel", &AlignerOptions::first_kernel,
             "m; first width of the residuals' kernel: how far the initial estimate may be off",
             1e-3, 100}};
}

template <class List, class Options>
List AlignerOptions::stagesOf(Options& o) {
    return {{"plane_map", &o.planeMap},
            {"plane_registration", &o.planes},
            {"normals", &o.normals},
            {"bilateral_filter", &o.bilateral},
            {"pattern_registration", &o.pattern}};
}

void AlignerOptions::loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                                        const std::string& section) {
    const std::string prefix = section + ".";
    const auto known = stagesOf<StageList>(*this);
    std::vector<std::string> sections;
    source.getAllSections(sections);
    for (const auto& name : sections)
        if (name.compare(0, prefix.size(), prefix) == 0 &&
            std::none_of(known.begin(), known.end(),
                         [&](const auto& stage) { return prefix + stage.first == name; }))
            throw Error("options section [" + name + "] does not exist");
    StageOptions::loadFromConfigFile(source, section);
    for (const auto& [name, stage] : known) stage->loadFromConfigFile(source, prefix + name);
}

void AlignerOptions::saveToConfigFile(mrpt::config::CConfigFileBase& target,
                                      const std::string& section) const {
    StageOptions::saveToConfigFile(target, section);
    for (const auto& [name, stage] : stagesOf<ConstStageList>(*this))
        stage->saveToConfigFile(target, section + "." + name);
}

void AlignerOptions::check(const std::string& section) const {
    for (const auto& [name, stage] : stagesOf<ConstStageList>(*this))
        stage->check(section + "." + name);
    requireOrder("twice " + section + ".plane_registration.last_kernel", 2 * planes.last_kernel,
                 section + ".first_kernel", first_kernel);
}

mrpt::poses::CPose3DPDF::Ptr Aligner::Align3DPDF(
    const CMetricMap* m1, const CMetricMap* m2, const CPose3DPDFGaussian& initialEstimationPDF,
    mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo) {
    Stopwatch watch;
    options.check("Aligner");
    const Eigen::Matrix3Xf from = pointsOf(m1, "first"), to = pointsOf(m2, "second");
    const Eigen::Isometry3d guess = fromMrpt(initialEstimationPDF.mean);
    if (!guess.matrix().allFinite()) throw Error("Aligner: the initial estimate is not finite");

    const Alignment alignment(from, to, options);
    PlaneEstimate estimate = alignment.fromEstimate(guess);
    double agreed = alignment.agreementAt(estimate);
    const bool searched = agreed < options.min_agreement;
    if (searched) {
        const auto found = alignment.searched(guess);
        if (alignment.agreementAt(found) > agreed) estimate = found;
        agreed = alignment.agreementAt(estimate);
    }
    if (!estimate.valid)
        throw Error("Aligner: within " + digitsOf(options.planes.search_radius) +
                    " m of the initial estimate fewer than " +
                    std::to_string(options.planes.min_matches) +
                    " points of the second map lie on planes of the first");
    estimate = alignment.inFirst(estimate);
    if (outInfo) tell(estimate, agreed, searched, watch.lap_ms() / 1e3, outInfo.value().get());
    return std::make_shared<CPose3DPDFGaussian>(
        graph::posePdfOf(incrementOf(estimate.rotation, estimate.translation)));
}

mrpt::poses::CPosePDF::Ptr Aligner::AlignPDF(
    const CMetricMap* m1, const CMetricMap* m2, const CPosePDFGaussian& initialEstimationPDF,
    mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo) {
    const auto in3D = Align3DPDF(m1, m2, CPose3DPDFGaussian(initialEstimationPDF), outInfo);
    return std::make_shared<CPosePDFGaussian>(*in3D);
}

namespace {
/** Features of a scan, which is one of a pair. */
std::shared_ptr<const odometry::PaperFeatures> featuresOf(
    const CMetricMap* map, const std::string& which, unsigned number,
    const std::shared_ptr<const PaperOdometryOptions>& options) {
    const Eigen::Matrix3Xf points = pointsOf(map, which);
    auto cloud = mrpt::maps::CSimplePointsMap::Create();
    cloud->reserve(static_cast<std::size_t>(points.cols()));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        cloud->insertPointFast(points(0, i), points(1, i), points(2, i));
    Scan scan;
    scan.points = cloud;
    auto usable = odometry::preprocess(scan, options->scan);
    const auto upright = odometry::uprightOf(usable.points).value_or(Eigen::Matrix3f::Identity());
    usable.rings = odometry::neighbouringRings(usable, upright);
    Step step;
    return odometry::featuresOf(usable, upright, number, options, step);
}
}  // namespace

mrpt::poses::CPose3DPDF::Ptr PaperAligner::Align3DPDF(
    const CMetricMap* m1, const CMetricMap* m2, const CPose3DPDFGaussian& initialEstimationPDF,
    mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo) {
    Stopwatch watch;
    const Eigen::Isometry3d guess = fromMrpt(initialEstimationPDF.mean);
    if (!guess.matrix().allFinite()) throw Error("Aligner: the initial estimate is not finite");
    const auto shared = std::make_shared<const PaperOdometryOptions>(options);
    const auto from = featuresOf(m1, "first", 0, shared), to = featuresOf(m2, "second", 1, shared);
    const auto found = odometry::registerFeatures(*from, *to, guess, 0, options);
    if (!found.predictedReason.empty())
        throw Error("Aligner: the second map is not registered to the first: " +
                    found.predictedReason);
    if (outInfo) {
        auto& out = outInfo.value().get();
        out.executionTime = watch.lap_ms() / 1e3;
        if (auto* icp = dynamic_cast<mrpt::slam::CICP::TReturnInfo*>(&out)) {
            icp->nIterations = found.rotation.iterations + found.translation.iterations;
            icp->goodness = found.translation.overlap;
            icp->quality = std::min(found.rotation.observability.minCoeff(),
                                    found.translation.observability.minCoeff());
        }
    }
    return std::make_shared<CPose3DPDFGaussian>(graph::posePdfOf(found.increment));
}

mrpt::poses::CPosePDF::Ptr PaperAligner::AlignPDF(
    const CMetricMap* m1, const CMetricMap* m2, const CPosePDFGaussian& initialEstimationPDF,
    mrpt::optional_ref<mrpt::slam::TMetricMapAlignmentResult> outInfo) {
    const auto in3D = Align3DPDF(m1, m2, CPose3DPDFGaussian(initialEstimationPDF), outInfo);
    return std::make_shared<CPosePDFGaussian>(*in3D);
}
}  // namespace delio
