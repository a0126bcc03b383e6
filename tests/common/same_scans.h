#pragma once
#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <cstring>

#include "delio/recordings/scan_reader.h"

namespace delio::test {
/** True where two runs of numbers are the same to the bit, NaN included. */
template <typename Numbers>
bool sameBits(const Numbers& a, const Numbers& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

/** Two scans are the same to the bit. */
inline void expectSameScan(const Scan& a, const Scan& b) {
    EXPECT_EQ(a.index, b.index);
    EXPECT_EQ(a.stamp_s, b.stamp_s);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.rings, b.rings);
    EXPECT_TRUE(sameBits(a.times_s, b.times_s));
    EXPECT_EQ(a.sensorPose.matrix(), b.sensorPose.matrix());
    using Xyzi = mrpt::maps::CPointsMapXYZI;
    const auto* p = dynamic_cast<const Xyzi*>(a.points.get());
    const auto* q = dynamic_cast<const Xyzi*>(b.points.get());
    ASSERT_TRUE(p && q);
    EXPECT_TRUE(sameBits(p->getPointsBufferRef_x(), q->getPointsBufferRef_x()));
    EXPECT_TRUE(sameBits(p->getPointsBufferRef_y(), q->getPointsBufferRef_y()));
    EXPECT_TRUE(sameBits(p->getPointsBufferRef_z(), q->getPointsBufferRef_z()));
    EXPECT_TRUE(sameBits(p->getPointsBufferRef_intensity(), q->getPointsBufferRef_intensity()));
}

/** All that two readers have left is the same; how many scans that was. */
inline std::size_t expectSameScans(io::ScanReader& a, io::ScanReader& b) {
    std::size_t scans = 0;
    while (const auto scan = a.next()) {
        const auto other = b.next();
        if (!other) {
            ADD_FAILURE() << "the second one ends after " << scans << " scans";
            return scans;
        }
        expectSameScan(*scan, *other);
        ++scans;
    }
    EXPECT_FALSE(b.next());
    return scans;
}

/** What they say of the drive is the same, but for who wrote it. */
inline void expectSameDrive(const io::ScanReader& a, const io::ScanReader& b) {
    ASSERT_TRUE(a.meta() && b.meta());
    EXPECT_EQ(a.meta()->sensorModel, b.meta()->sensorModel);
    EXPECT_EQ(a.meta()->source, b.meta()->source);
    EXPECT_EQ(a.meta()->motionCompensated, b.meta()->motionCompensated);
    EXPECT_EQ(a.meta()->verticalCorrectionDeg, b.meta()->verticalCorrectionDeg);
    EXPECT_EQ(a.meta()->epoch_s, b.meta()->epoch_s);
    EXPECT_EQ(a.label(), b.label());
    EXPECT_EQ(a.calibration().text, b.calibration().text);
    EXPECT_EQ(a.truth().text, b.truth().text);
}
}  // namespace delio::test
