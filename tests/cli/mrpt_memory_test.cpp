#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <new>

#include "memory_limit.h"

namespace {
// What programs have in place of MRPT's aligned_malloc (apps/common/cli.cpp): MRPT 2.5.8 alone ends
// with a segmentation fault.
TEST(MrptMemory, PointsForWhichThereIsNone) {
    if (!delio::test::MemoryLimit::works()) GTEST_SKIP() << "the sanitizer ends the process";
    constexpr std::size_t kMegabytes = 64, kPoints = 100'000'000;
    const auto points = mrpt::maps::CPointsMapXYZI::Create();
    const delio::test::MemoryLimit limit(kMegabytes);
    EXPECT_THROW(points->resize(kPoints), std::bad_alloc);
    EXPECT_THROW(points->reserve(kPoints), std::bad_alloc);
}
}  // namespace
