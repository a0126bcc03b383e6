#pragma once
#include <gtest/gtest.h>
#include <mrpt/maps/CPointsMapXYZI.h>

#include <string>
#include <vector>

#include "delio/run/run.h"
#include "delio/run/run_folder.h"
#include "test_data.h"
#include "toy_drive.h"

namespace delio::test {
inline Scan scanOf(const Floats& xyzi) {
    auto points = mrpt::maps::CPointsMapXYZI::Create();
    points->resize(xyzi.size() / 4);
    for (std::size_t i = 0; i + 3 < xyzi.size(); i += 4) {
        points->setPointFast(i / 4, xyzi[i], xyzi[i + 1], xyzi[i + 2]);
        points->setPointIntensity(i / 4, xyzi[i + 3]);
    }
    Scan scan;
    scan.points = points;
    return scan;
}

/** A toy drive through run::Run, into a folder. */
class ToyRun : public testing::Test {
 protected:
    static constexpr std::size_t kScans = 4;

    /** Scans 10, 11, 12 ... 1 m and 0.1 s apart. */
    static std::vector<Scan> scans() {
        std::vector<Scan> scans;
        for (const auto& xyzi : toyScans(kScans)) {
            scans.push_back(scanOf(xyzi));
            scans.back().index = 9 + scans.size();
            scans.back().stamp_s = 0.1 * static_cast<double>(scans.size());
            scans.back().time = mrpt::Clock::fromDouble(1e9 + scans.back().stamp_s);
        }
        return scans;
    }
    /** What lies beside a drive d.rawlog: calibration, and true poses of the first scans. */
    void writeSideFiles() const {
        writeText(folder_ / "d.calib.txt", "Tr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n");
        std::string poses;
        for (std::size_t i = 0; i < 10 + kScans; ++i)
            poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(i) + "\n";
        writeText(folder_ / "d.poses.txt", poses);
    }
    static void process(run::Run& run) {
        for (const auto& scan : scans()) run.process(scan, 1.5);
    }

    TemporaryFolder folder_;
    std::string drive_ = folder_ / "d.rawlog";
    std::string out_ = folder_ / "out";
};
}  // namespace delio::test
