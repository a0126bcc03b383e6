#include "delio/slam/odometry_map_builder.h"

#include <mrpt/img/CImage.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDF.h>

#include <algorithm>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "core/voxel_grid.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/graph/pose_graph.h"
#include "delio/slam/slam.h"
#include "mrpt/imu_observation.h"
#include "mrpt/odometry_observation.h"
#include "recordings/decode_observation.h"

namespace delio {
using mrpt::config::CConfigFileBase;
using mrpt::maps::CMultiMetricMap;
using mrpt::maps::CSimplePointsMap;
using mrpt::poses::CPose3DPDFGaussian;

std::vector<OptionField> OdometryMapBuilderOptions::fields() const {
    using O = OdometryMapBuilderOptions;
    return {{"profile", &O::profile, "profile of the odometry", Options::profileNames()},
            {"keyframe_distance", &O::keyframe_distance, "m; way between keyframes", 0.01, 1000},
            {"keyframe_angle_deg", &O::keyframe_angle_deg, "rotation between keyframes", 0.1, 180},
            {"map_resolution", &O::map_resolution, "m; distance between points of the metric map",
             0.001, 10}};
}

void OdometryMapBuilderOptions::loadFromConfigFile(const CConfigFileBase& source,
                                                   const std::string& section) {
    StageOptions::loadFromConfigFile(source, section);
    stages = Options::ofProfile(profile);
    std::vector<std::string> sections;
    source.getAllSections(sections);
    const std::string prefix = section + ".";
    for (const auto& name : sections) {
        if (name.rfind(prefix, 0) != 0) continue;
        std::vector<std::string> keys;
        source.getAllKeys(name, keys);
        for (const auto& key : keys)
            stages.set(name.substr(prefix.size()) + "." + key + "=" +
                       source.read_string(name, key, ""));
    }
    stages.check();
}

void OdometryMapBuilderOptions::saveToConfigFile(CConfigFileBase& target,
                                                 const std::string& section) const {
    StageOptions::saveToConfigFile(target, section);
    for (const auto& [name, stage] : stages.stages())
        stage->saveToConfigFile(target, section + "." + name);
}

/** The scans that entered the map. */
class OdometryMapBuilder::Keyframes : public SlamListener {
 public:
    Keyframes(const OdometryMapBuilderOptions& options,
              const mrpt::slam::CMetricMapBuilder& builder, const Eigen::Isometry3d& start)
        : options_(options), builder_(builder), start_(start), pdf_(toMrpt(start)) {
        mrpt::maps::TSetOfMetricMapInitializers maps;
        maps.push_back(CSimplePointsMap::TMapDefinition());
        metricMap_.setListOfMaps(maps);
    }

    const char* name() const override { return "map_builder"; }

    void add(const SlamScan& scan) override {
        pdf_ += graph::posePdfOf(scan.increment);
        pose_ = start_ * scan.pose;
        pdf_.mean = toMrpt(pose_);
        step_ = scan.step;
        step_->features.reset();
        correct(scan);
        if (scan.step.predicted || !builder_.options.enableMapUpdating || !isFarEnough()) return;
        const auto cloud = mrpt::obs::CObservationPointCloud::Create();
        cloud->timestamp = scan.scan.time;
        cloud->sensorLabel = "delio";
        const auto points = CSimplePointsMap::Create();
        const Eigen::Matrix3Xf used = staticPoints(scan);
        for (Eigen::Index i = 0; i < used.cols(); ++i)
            points->insertPointFast(used(0, i), used(1, i), used(2, i));
        cloud->pointcloud = points;
        keyframes_.push_back({scan.node, pose_, pdf_.cov, cloud});
        insert(keyframes_.back());
    }

    const std::optional<Step>& step() const { return step_; }
    const CPose3DPDFGaussian& pdf() const { return pdf_; }
    const CMultiMetricMap& metricMap() const { return metricMap_; }
    std::size_t size() const { return keyframes_.size(); }

    mrpt::maps::CSimpleMap simpleMap() const {
        mrpt::maps::CSimpleMap map;
        for (const Keyframe& keyframe : keyframes_) {
            const auto pdf = CPose3DPDFGaussian::Create();
            pdf->mean = toMrpt(keyframe.pose);
            pdf->cov = keyframe.covariance;
            const auto frame = mrpt::obs::CSensoryFrame::Create();
            frame->insert(keyframe.cloud);
            map.insert(pdf, frame);
        }
        return map;
    }

 private:
    struct Keyframe {
        std::size_t node;
        Eigen::Isometry3d pose;
        mrpt::math::CMatrixDouble66 covariance;
        mrpt::obs::CObservationPointCloud::Ptr cloud;
    };

    bool isFarEnough() const {
        if (keyframes_.empty() || builder_.options.debugForceInsertion) return true;
        const Eigen::Isometry3d moved = keyframes_.back().pose.inverse() * pose_;
        return moved.translation().norm() > options_.keyframe_distance ||
               angleOf(moved.linear()) > options_.keyframe_angle_deg * M_PI / 180;
    }

    /** A copy: maps that were given away share the cloud. */
    static mrpt::obs::CObservationPointCloud::Ptr movedCloud(
        const mrpt::obs::CObservationPointCloud& cloud, const Eigen::Isometry3d& motion) {
        const auto moved = mrpt::obs::CObservationPointCloud::Create(cloud);
        moved->pointcloud = std::dynamic_pointer_cast<mrpt::maps::CPointsMap>(
            cloud.pointcloud->duplicateGetSmartPtr());
        moved->pointcloud->changeCoordinatesReference(toMrpt(motion));
        return moved;
    }

    /** Earlier scans are now known to have been elsewhere. */
    void correct(const SlamScan& scan) {
        bool isMoved = false;
        for (const auto& [node, pose] : scan.corrected)
            for (Keyframe& keyframe : keyframes_) {
                if (keyframe.node != node) continue;
                keyframe.pose = start_ * pose;
                if (scan.fromOldPose && node + 1 == scan.node)
                    keyframe.cloud = movedCloud(*keyframe.cloud, *scan.fromOldPose);
                else
                    isMoved = true;
            }
        if (!isMoved) return;
        metricMap_.clear();
        occupied_.clear();
        for (const Keyframe& keyframe : keyframes_) insert(keyframe);
    }

    /** Into the metric map: one point per voxel. */
    void insert(const Keyframe& keyframe) {
        const auto map = metricMap_.mapByClass<CSimplePointsMap>();
        const auto& cloud = *keyframe.cloud->pointcloud;
        for (std::size_t i = 0; i < cloud.size(); ++i) {
            Eigen::Vector3d point;
            cloud.getPoint(i, point.x(), point.y(), point.z());
            point = keyframe.pose * point;
            if (!occupied_.insert(voxelKey(point, options_.map_resolution)).second) continue;
            const Eigen::Vector3f kept = point.cast<float>();
            map->insertPoint(kept.x(), kept.y(), kept.z());
        }
    }

    const OdometryMapBuilderOptions& options_;
    const mrpt::slam::CMetricMapBuilder& builder_;
    Eigen::Isometry3d start_, pose_ = Eigen::Isometry3d::Identity();
    CPose3DPDFGaussian pdf_;
    std::optional<Step> step_;
    std::vector<Keyframe> keyframes_;
    CMultiMetricMap metricMap_;
    std::unordered_set<std::uint64_t> occupied_;  //!< voxels of the metric map
};

OdometryMapBuilder::OdometryMapBuilder(const OdometryMapBuilderOptions& o) : own_(o) {
    setLoggerName("OdometryMapBuilder");
    begin(Eigen::Isometry3d::Identity());
}

OdometryMapBuilder::~OdometryMapBuilder() = default;

void OdometryMapBuilder::begin(const Eigen::Isometry3d& start) {
    slam_ = std::make_unique<Slam>(makeOdometry(own_.stages), History::Last);
    keyframes_ = std::make_shared<Keyframes>(own_, *this, start);
    slam_->attach(keyframes_);
    scans_ = 0;
}

void OdometryMapBuilder::initialize(const mrpt::maps::CSimpleMap& initialMap,
                                    const mrpt::poses::CPosePDF* x0) {
    if (!initialMap.empty())
        throw Error(
            "the map builder cannot continue a map: begin with an empty one, or localise in a "
            "stored map");
    mrpt::poses::CPose2D mean;
    if (x0 != nullptr) x0->getMean(mean);
    begin(fromMrpt(mrpt::poses::CPose3D(mean)));
}

bool OdometryMapBuilder::processObservation(const mrpt::obs::CObservation::Ptr& observation) {
    if (!observation) throw Error("there is no observation (null)");
    const double stamp_s = mrpt::Clock::toDouble(observation->timestamp);
    if (const auto imu = std::dynamic_pointer_cast<mrpt::obs::CObservationIMU>(observation)) {
        slam_->addImu(io::sampleOf(*imu, stamp_s));
        return true;
    }
    if (const auto sample = io::odometryOf(*observation, stamp_s)) {
        slam_->addOdometry(*sample);
        return true;
    }
    if (!io::isScan(*observation)) return false;
    observation->load();
    Scan scan = io::decodeObservation(*observation);
    scan.index = scans_++;
    scan.stamp_s = stamp_s;
    scan.time = observation->timestamp;
    const auto report = slam_->process(scan);
    for (const auto& failed : report.failed) throw Error(failed.message);
    if (report.step.lost)
        MRPT_LOG_WARN_STREAM("scan " << scan.index << ": lost: " << report.step.reason);
    else
        MRPT_LOG_DEBUG_STREAM("scan " << scan.index << ": " << report.step.quality.matches
                                      << " matches");
    return true;
}

void OdometryMapBuilder::processActionObservation(mrpt::obs::CActionCollection& /*action*/,
                                                  mrpt::obs::CSensoryFrame& observations) {
    for (const auto& observation : observations) processObservation(observation);
}

const Step& OdometryMapBuilder::latestStep() const {
    if (!keyframes_->step()) throw Error("no scan was processed yet");
    return *keyframes_->step();
}

mrpt::poses::CPose3DPDF::Ptr OdometryMapBuilder::getCurrentPoseEstimation() const {
    return std::make_shared<CPose3DPDFGaussian>(keyframes_->pdf());
}

void OdometryMapBuilder::getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& map) const {
    map = keyframes_->simpleMap();
}

unsigned int OdometryMapBuilder::getCurrentlyBuiltMapSize() {
    return static_cast<unsigned int>(keyframes_->size());
}

const CMultiMetricMap* OdometryMapBuilder::getCurrentlyBuiltMetricMap() const {
    return &keyframes_->metricMap();
}

void OdometryMapBuilder::saveCurrentEstimationToImage(const std::string& file, bool /*unused*/) {
    constexpr int kWidth = 1024;
    const auto points = keyframes_->metricMap().mapByClass<CSimplePointsMap>();
    if (!points || points->empty()) throw Error("there is no point in the map");
    const auto box = points->boundingBox();
    const double perPixel_m = std::max<double>(box.max.x - box.min.x, 1e-3) / kWidth;
    const int height =
        std::clamp(static_cast<int>((box.max.y - box.min.y) / perPixel_m), 1, 16 * kWidth);
    mrpt::img::CImage picture(kWidth, height, mrpt::img::CH_RGB);
    picture.filledRectangle(0, 0, kWidth - 1, height - 1, mrpt::img::TColor::white());
    for (std::size_t i = 0; i < points->size(); ++i) {
        double x = 0, y = 0, z = 0;
        points->getPoint(i, x, y, z);
        picture.setPixel(static_cast<int>((x - box.min.x) / perPixel_m),
                         height - 1 - static_cast<int>((y - box.min.y) / perPixel_m), 0);
    }
    if (!picture.saveToFile(file)) throw Error("cannot write '" + file + "'");
}
}  // namespace delio
