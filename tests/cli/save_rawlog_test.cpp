// delio-slam --save-rawlog: the input rawlog with the motion between its scans.
#include <gtest/gtest.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DInterpolator.h>

#include "delio/core/geometry.h"
#include "delio/formats/trajectory.h"
#include "delio_slam_fixture.h"
#include "rawlog_files.h"

namespace {
using namespace delio;
using test::operator+;
using mrpt::obs::CActionRobotMovement3D;
namespace fs = std::filesystem;

class SaveRawlog : public test::DelioSlam {
 protected:
    void SetUp() override {
        const auto made = test::runTool(
            "synth2rawlog", {"-o", rawlog_, "--scene", "urban", "--sensor", "vlp16", "--scans",
                             "12", "--seed", "6", "--start", "moving", "--imu", "50"});
        ASSERT_EQ(made.exitCode, 0) << made.err;
    }
    test::CommandResult save(const test::Words& more = {}) const {
        return slam(test::Words{"--save-rawlog", copy_} + more);
    }
    static std::size_t count(const mrpt::obs::CRawlog& rawlog,
                             mrpt::obs::CRawlog::TEntryType type) {
        std::size_t found = 0;
        for (std::size_t i = 0; i < rawlog.size(); ++i) found += rawlog.getType(i) == type;
        return found;
    }
    const std::string copy_ = folder_ / "copy.rawlog";
};

TEST_F(SaveRawlog, ActionsLeadAlongTheTrajectory) {
    const auto run = save();
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_NE(run.err.find("with 12 actions"), std::string::npos) << run.err;
    mrpt::obs::CRawlog rawlog, input;
    ASSERT_TRUE(rawlog.loadFromRawLogFile(copy_, true));
    ASSERT_TRUE(input.loadFromRawLogFile(rawlog_, true));
    using mrpt::obs::CRawlog;
    EXPECT_EQ(count(rawlog, CRawlog::etSensoryFrame), 12U);
    EXPECT_EQ(count(rawlog, CRawlog::etActionCollection), 12U);
    EXPECT_EQ(count(rawlog, CRawlog::etObservation) + 12, count(input, CRawlog::etObservation));
    const auto poses = io::readTrajectory(out_ / "trajectory_kitti.txt").poses;
    mrpt::poses::CPose3D pose;
    std::size_t scan = 0;
    for (std::size_t i = 0; i < rawlog.size(); ++i) {
        if (rawlog.getType(i) != CRawlog::etActionCollection) continue;
        const auto action = rawlog.getAsAction(i)->getActionByClass<CActionRobotMovement3D>();
        ASSERT_TRUE(action);
        pose = pose + action->poseChange.mean;
        EXPECT_TRUE(fromMrpt(pose).isApprox(poses[scan], 1e-6)) << scan;
        const auto cov = action->poseChange.cov.asEigen();
        EXPECT_GT(cov.diagonal().minCoeff(), 0);
        EXPECT_LT(cov.diagonal().maxCoeff(), 1e-2);
        ASSERT_EQ(rawlog.getType(i + 1), CRawlog::etSensoryFrame);
        EXPECT_EQ(action->timestamp,
                  rawlog.getAsObservations(i + 1)->getObservationByIndex(0)->timestamp);
        ++scan;
    }
}

TEST_F(SaveRawlog, TheCopyIsARecordingLikeTheInput) {
    ASSERT_EQ(save().exitCode, 0);
    const auto again = folder_ / "again";
    const auto run = test::runTool("delio-slam", {"-i", copy_, "-o", again, "--no-map"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_TRUE(test::readText(fs::path(again) / "trajectory_kitti.txt") ==
                test::readText(out_ / "trajectory_kitti.txt"));
    const auto info = test::runTool("rawlog-edit", {"--info", "-i", copy_});
    if (info.exitCode == 127) GTEST_SKIP() << "rawlog-edit (mrpt-apps) is not installed";
    EXPECT_EQ(info.exitCode, 0) << info.err;
    EXPECT_NE(info.out.find("Actions/SensoryFrame format       : Yes"), std::string::npos)
        << info.out;
    // A copy of the copy: its frames keep their bytes, and its actions get a second motion.
    const auto second =
        test::runTool("delio-slam", {"-i", copy_, "-o", folder_ / "more", "--no-map",
                                     "--save-rawlog", folder_ / "second.rawlog"});
    ASSERT_EQ(second.exitCode, 0) << second.err;
    mrpt::obs::CRawlog rawlog;
    ASSERT_TRUE(rawlog.loadFromRawLogFile(folder_ / "second.rawlog", true));
    std::size_t motions = 0;
    for (std::size_t i = 0; i < rawlog.size(); ++i)
        if (rawlog.getType(i) == mrpt::obs::CRawlog::etActionCollection)
            motions += rawlog.getAsAction(i)->size();
    EXPECT_EQ(motions, 24U);
}

TEST_F(SaveRawlog, TheTrajectoryIsAnInterpolatorOfMrpt) {
    ASSERT_EQ(slam().exitCode, 0);
    mrpt::poses::CPose3DInterpolator poses;
    ASSERT_TRUE(poses.loadFromTextFile((out_ / "trajectory_mrpt.txt").string()));
    EXPECT_EQ(poses.size(), 12U);
    const auto final = io::readTrajectory(out_ / "trajectory_kitti.txt").poses;
    io::RawlogReader reader(rawlog_);
    for (std::size_t i = 0; const auto scan = reader.next(); ++i) {
        mrpt::poses::CPose3D pose;
        bool valid = false;
        poses.interpolate(scan->time + std::chrono::microseconds(1), pose, valid);
        EXPECT_EQ(valid, i + 1 < final.size()) << i;  // after the last pose there is none
        if (valid) {
            EXPECT_LT((fromMrpt(pose).matrix() - final[i].matrix()).norm(), 1e-3) << i;
        }
    }
}

TEST_F(SaveRawlog, Errors) {
    const fs::path clouds = folder_ / "clouds";
    fs::create_directory(clouds);
    test::writeText(clouds / "0.txt", "1 2 3\n");
    test::expectFailure(slamOf(clouds, {"--save-rawlog", copy_}), 1, {"scans2rawlog"});
    expectRefused(slam({"--save-rawlog", folder_ / "copy.bag"}), 2, {"FILE.rawlog"});
    expectRefused(slam({"--save-rawlog", rawlog_, "--force"}), 1, {"is also the input"});
    test::writeText(copy_, "old");
    expectRefused(save(), 1, {"exists", "--force"});
    EXPECT_EQ(test::readText(copy_), "old");
    ASSERT_EQ(save({"--force"}).exitCode, 0);
    EXPECT_GT(test::readText(copy_).size(), 1000U);
}
}  // namespace
