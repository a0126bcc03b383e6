#include "delio/formats/trajectory.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <fstream>

#include "delio/core/error.h"
#include "poses.h"
#include "test_data.h"

namespace {
using namespace delio;

const std::string kIdentityRow = "1 0 0 0 0 1 0 0 0 0 1 0";

std::string messageOf(const std::string& path) {
    try {
        io::readTrajectory(path);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(Trajectory, KittiAndTumGiveTheSameDoublesBack) {
    const test::TemporaryFolder folder;
    io::Trajectory drive;
    for (int i = 0; i < 50; ++i) {
        drive.poses.push_back(test::poseAt(1.0 / 3 * i, -0.1 * i, 7e-9, 0.06 * i, 0.01, -0.3));
        drive.stamps_s.push_back(0.1037359 * i);
    }
    io::writeKitti(drive, folder / "kitti.txt");
    io::writeTum(drive, folder / "tum.txt");
    const auto kitti = io::readTrajectory(folder / "kitti.txt");
    const auto tum = io::readTrajectory(folder / "tum.txt");
    ASSERT_EQ(kitti.poses.size(), drive.poses.size());
    ASSERT_EQ(tum.poses.size(), drive.poses.size());
    EXPECT_EQ(tum.stamps_s, drive.stamps_s);
    for (std::size_t i = 0; i < drive.poses.size(); ++i) {
        EXPECT_EQ(kitti.poses[i].translation().x(), drive.poses[i].translation().x());
        const Eigen::Matrix3d R = drive.poses[i].linear();
        EXPECT_LT((kitti.poses[i].linear() - R).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_LT((tum.poses[i].linear() - R).cwiseAbs().maxCoeff(), 1e-14);
    }
}

TEST(Trajectory, TumHasTheQuaternionWhoseScalarIsNotNegative) {
    const test::TemporaryFolder folder;
    io::Trajectory drive;
    for (int i = 0; i < 36; ++i) {
        drive.poses.push_back(test::poseAtDeg(0, 0, 0, 10 * i, 3, -2));
        drive.stamps_s.push_back(i);
    }
    io::writeTum(drive, folder / "tum.txt");
    std::ifstream in(folder / "tum.txt");
    double number = 0, scalar = 0;
    for (std::size_t i = 0; i < drive.poses.size(); ++i) {
        for (int k = 0; k < 7; ++k) in >> number;
        in >> scalar;
        ASSERT_TRUE(in);
        EXPECT_GE(scalar, 0);
        EXPECT_LT(
            test::degreesBetween(io::readTrajectory(folder / "tum.txt").poses[i], drive.poses[i]),
            1e-6);
    }
}

TEST(Trajectory, AcceptsTrailingSpacesEmptyLinesCommentsAndCr) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "a.txt", "# x\n" + kIdentityRow + "  \r\n\n" + kIdentityRow + " \n");
    EXPECT_EQ(io::readTrajectory(folder / "a.txt").poses.size(), 2U);
}

TEST(Trajectory, EachFaultIsNamedWithItsLine) {
    const test::TemporaryFolder folder;
    const auto fault = [&](const std::string& text) {
        test::writeText(folder / "a.txt", text);
        return messageOf(folder / "a.txt");
    };
    EXPECT_NE(messageOf(folder / "none.txt").find("no such file"), std::string::npos);
    EXPECT_NE(fault("").find("empty"), std::string::npos);
    EXPECT_NE(fault(kIdentityRow + "\n1 2 3\n").find("line 2: 3 numbers"), std::string::npos);
    EXPECT_NE(
        fault(kIdentityRow + "\n1 0 0 nan 0 1 0 0 0 0 1 0\n").find("line 2: expected a finite"),
        std::string::npos);
    EXPECT_NE(fault("2 0 0 0 0 1 0 0 0 0 1 0\n").find("not a rotation"), std::string::npos);
    EXPECT_NE(fault("1 0 0 0 0 0 0 1\n0.5 0 0 0 0 0 0 1\n").find("must increase"),
              std::string::npos);
    EXPECT_NE(messageOf(folder.path()).find("cannot read"), std::string::npos);
}

TEST(Trajectory, ACalibrationWithoutTrIsNoError) {
    const test::TemporaryFolder folder;
    test::writeText(folder / "calib.txt", "P0: 1 0 0 0 0 1 0 0 0 0 1 0\n");
    EXPECT_FALSE(io::readCalibration(folder / "calib.txt").hasTr);
    test::writeText(folder / "calib.txt", "Tr: 0 -1 0 0 0 0 -1 0 1 0 0 -0.3\n");
    const auto calibration = io::readCalibration(folder / "calib.txt");
    ASSERT_TRUE(calibration.hasTr);
    io::Trajectory lidar;
    lidar.poses = {test::poseAt(0, 0, 0), test::poseAt(2, 0, 0)};
    EXPECT_NEAR(io::lidarToCam0(lidar, calibration.Tr).poses[1].translation().z(), 2, 1e-12);
}
}  // namespace
