#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include <functional>

#include "delio/core/error.h"
#include "delio/odometry/aligner.h"
#include "ring_scan.h"

using namespace delio;

namespace {

AlignerOptions loaded(const std::string& lines) {
    AlignerOptions options;
    options.loadFromConfigFile(mrpt::config::CConfigFileMemory(lines), "my");
    return options;
}

/** What is thrown, or "" if nothing is. */
std::string errorOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

/** What comes of aligning a scan of the yard with itself, in 3D and in 2D. */
std::string errorOfAligning(const AlignerOptions& options) {
    test::Noise noise;
    const auto scan =
        test::scanOf(test::ringScan(test::yard(), Eigen::Isometry3d::Identity(), {}, noise).points);
    Aligner aligner(options);
    const auto* map = scan.points.get();
    const auto error = errorOf([&] { aligner.Align3D(map, map, {}); });
    EXPECT_EQ(errorOf([&] { aligner.Align(map, map, {}); }), error);
    return error;
}

TEST(AlignerOptions, OfTheirOwnGoTogether) { EXPECT_EQ(errorOfAligning({}), ""); }

TEST(AlignerOptions, AKernelThatWouldWidenIsRefusedWhenAligning) {
    // Loading asks nothing: of two that change, one comes first.
    const auto options =
        loaded("[my]\nfirst_kernel = 0.5\n[my.plane_registration]\nlast_kernel = 0.3\n");
    EXPECT_EQ(options.planes.last_kernel, 0.3);
    EXPECT_EQ(errorOfAligning(options),
              "option twice Aligner.plane_registration.last_kernel (0.6) must be at most "
              "Aligner.first_kernel (0.5)");
    EXPECT_EQ(errorOfAligning(loaded("[my.plane_registration]\nlast_kernel = 0.5\n")), "");
}

TEST(AlignerOptions, EveryStageIsAsked) {
    AlignerOptions options;  // set by a program, not loaded
    options.pattern.kernel_deg = 1;
    options.pattern.last_kernel_deg = 2;
    EXPECT_EQ(errorOf([&] { options.check("my"); }),
              "option my.pattern_registration.last_kernel_deg (2) must be at most "
              "my.pattern_registration.kernel_deg (1)");
    EXPECT_EQ(errorOfAligning(options),
              "option Aligner.pattern_registration.last_kernel_deg (2) must be at most "
              "Aligner.pattern_registration.kernel_deg (1)");
}
}  // namespace
