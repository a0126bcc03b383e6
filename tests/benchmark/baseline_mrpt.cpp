#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/slam/CICP.h>

#include "baseline.h"
#include "core/voxel_grid.h"
#include "delio/core/geometry.h"

namespace delio::benchmark {
using mrpt::maps::CSimplePointsMap;

namespace {
constexpr double kVoxel_m = 0.5;

/** MRPT's own ICP, in 3D, point to point. */
class MrptIcp : public ScanToScan<CSimplePointsMap::Ptr> {
 public:
    explicit MrptIcp(const DriveFacts& facts) : ScanToScan(facts) {
        icp_.setMinLoggingLevel(mrpt::system::LVL_ERROR);
        icp_.options.maxIterations = 80;
        icp_.options.thresholdDist = 1.5;  // shrinks by ALFA each time the pose settles
        icp_.options.thresholdAng = 0;
        icp_.options.smallestThresholdDist = 0.2;
    }

 protected:
    CSimplePointsMap::Ptr extract(const odometry::PointCloud& cloud) override {
        const Eigen::Matrix3Xf points = voxelCentroids(cloud.points, kVoxel_m);
        auto map = CSimplePointsMap::Create();
        map->resize(static_cast<std::size_t>(points.cols()));
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            map->setPoint(static_cast<std::size_t>(i), points(0, i), points(1, i), points(2, i));
        return map;
    }
    Eigen::Isometry3d align(const CSimplePointsMap::Ptr& from, const CSimplePointsMap::Ptr& to,
                            const Eigen::Isometry3d& guess) override {
        const auto found =
            icp_.Align3DPDF(from.get(), to.get(), mrpt::poses::CPose3DPDFGaussian(toMrpt(guess)));
        return found ? fromMrpt(found->getMeanVal()) : guess;
    }

 private:
    mrpt::slam::CICP icp_;
};
}  // namespace

std::unique_ptr<Baseline> makeMrptIcp(const DriveFacts& facts) {
    return std::make_unique<MrptIcp>(facts);
}
}  // namespace delio::benchmark
