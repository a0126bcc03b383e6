#include <pcl/features/normal_3d.h>
#include <pcl/io/pcd_io.h>  // MRPT's point clouds want it once PCL is known
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>

#include <Eigen/Dense>

#include "baseline.h"
#include "core/voxel_grid.h"
#include "delio/core/geometry.h"

namespace delio::benchmark {
namespace {
// Common choices: one point in half a metre, pairs of at most a metre, iterated until it settles.
constexpr double kVoxel_m = 0.5;
constexpr double kFarthestPair_m = 1;
constexpr int kIterations = 50;
constexpr double kSettled = 1e-6;
constexpr int kNormalNeighbours = 10;
constexpr float kNdtCell_m = 2;
constexpr double kNdtStep_m = 0.2;

template <typename Point>
using Cloud = typename pcl::PointCloud<Point>::Ptr;

/** Any registration of PCL. */
template <typename Point, typename Registration>
class Pcl : public ScanToScan<Cloud<Point>> {
 public:
    explicit Pcl(const DriveFacts& facts) : ScanToScan<Cloud<Point>>(facts) {
        registration.setMaxCorrespondenceDistance(kFarthestPair_m);
        registration.setMaximumIterations(kIterations);
        registration.setTransformationEpsilon(kSettled);
    }
    Registration registration;

 protected:
    Cloud<Point> extract(const odometry::PointCloud& cloud) override {
        const Eigen::Matrix3Xf points = voxelCentroids(cloud.points, kVoxel_m);
        Cloud<Point> result(new pcl::PointCloud<Point>);
        result->resize(static_cast<std::size_t>(points.cols()));
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            (*result)[static_cast<std::size_t>(i)].getVector3fMap() = points.col(i);
        return result;
    }
    Eigen::Isometry3d align(const Cloud<Point>& from, const Cloud<Point>& to,
                            const Eigen::Isometry3d& guess) override {
        registration.setInputTarget(from);
        registration.setInputSource(to);
        pcl::PointCloud<Point> aligned;
        registration.align(aligned, guess.matrix().template cast<float>());
        if (!registration.hasConverged()) return guess;
        const Eigen::Matrix4d T = registration.getFinalTransformation().template cast<double>();
        if (!T.allFinite()) return guess;
        const Eigen::Quaterniond q(Eigen::Matrix3d(T.topLeftCorner<3, 3>()));
        return isometry(q.normalized().toRotationMatrix(), T.topRightCorner<3, 1>());
    }
};

using PlaneIcp = pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal>;

class PclPlaneIcp : public Pcl<pcl::PointNormal, PlaneIcp> {
 public:
    using Pcl::Pcl;

 protected:
    Cloud<pcl::PointNormal> extract(const odometry::PointCloud& cloud) override {
        auto points = Pcl::extract(cloud);
        pcl::NormalEstimation<pcl::PointNormal, pcl::PointNormal> normals;
        normals.setInputCloud(points);
        normals.setKSearch(kNormalNeighbours);
        normals.compute(*points);
        return points;
    }
};
}  // namespace

std::unique_ptr<Baseline> makePclIcp(const DriveFacts& facts) {
    return std::make_unique<
        Pcl<pcl::PointXYZ, pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>>(facts);
}

std::unique_ptr<Baseline> makePclPlaneIcp(const DriveFacts& facts) {
    return std::make_unique<PclPlaneIcp>(facts);
}

std::unique_ptr<Baseline> makePclGicp(const DriveFacts& facts) {
    using Gicp = pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>;
    return std::make_unique<Pcl<pcl::PointXYZ, Gicp>>(facts);
}

std::unique_ptr<Baseline> makePclNdt(const DriveFacts& facts) {
    using Ndt = pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>;
    auto baseline = std::make_unique<Pcl<pcl::PointXYZ, Ndt>>(facts);
    baseline->registration.setResolution(kNdtCell_m);
    baseline->registration.setStepSize(kNdtStep_m);
    baseline->registration.setTransformationEpsilon(1e-3);
    return baseline;
}
}  // namespace delio::benchmark
