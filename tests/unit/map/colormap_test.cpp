#include "delio/map/colormap.h"

#include <gtest/gtest.h>

#include <cmath>

#include "delio/core/error.h"

namespace {
using namespace delio;

TEST(Colormap, RobustRangeIgnoresStrays) {
    std::vector<float> values;
    for (int i = 0; i <= 1000; ++i) values.push_back(static_cast<float>(i));
    values.push_back(1e9F);
    values.push_back(std::nanf(""));
    const auto range = map::robustRange(values);
    EXPECT_NEAR(range.low, 20, 1);
    EXPECT_NEAR(range.high, 980, 1);
    EXPECT_GT(map::robustRange({5, 5, 5}).high, map::robustRange({5, 5, 5}).low);
    EXPECT_EQ(map::robustRange({}).high, 1);
    EXPECT_THROW(map::colormapNamed("jet"), Error);
    for (const auto& name : map::colormapNames()) EXPECT_NO_THROW(map::colormapNamed(name));
}
}  // namespace
