#include "recordings/decode_observation.h"

#include <gtest/gtest.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <cmath>

#include "delio/core/error.h"

namespace {
using namespace delio;
using mrpt::obs::CObservation3DRangeScan;

TEST(DepthCamera, ARangeImageAloneIsProjected) {
    CObservation3DRangeScan camera;
    camera.hasRangeImage = true;
    camera.range_is_depth = true;
    camera.rangeUnits = 0.001F;
    camera.rangeImage_setSize(3, 4);
    camera.rangeImage.fill(0);
    camera.rangeImage(0, 3) = 4000;
    camera.rangeImage(2, 0) = 5000;
    camera.cameraParams.ncols = 4;
    camera.cameraParams.nrows = 3;
    camera.cameraParams.setIntrinsicParamsFromValues(2, 2, 1, 1);
    const auto points = io::decodeObservation(camera).points;
    ASSERT_EQ(points->size(), 2U);
    const float expected[2][3] = {{4, -4, 2}, {5, 2.5F, -2.5F}};
    for (std::size_t i = 0; i < 2; ++i) {
        float x = 0, y = 0, z = 0;
        points->getPoint(i, x, y, z);
        EXPECT_NEAR(x, expected[i][0], 1e-5);
        EXPECT_NEAR(y, expected[i][1], 1e-5);
        EXPECT_NEAR(z, expected[i][2], 1e-5);
    }
}

TEST(SensorPose, HasToBeFinite) {
    mrpt::obs::CObservationPointCloud scan;
    scan.pointcloud = mrpt::maps::CSimplePointsMap::Create();
    EXPECT_NO_THROW(io::decodeObservation(scan));
    for (const double x : {std::nan(""), HUGE_VAL, 2e9}) {
        scan.sensorPose.x(x);
        EXPECT_THROW(io::decodeObservation(scan), Error) << x;
    }
}
}  // namespace
