#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "core/principal_axes.h"
#include "core/scan_trajectory.h"
#include "delio/core/geometry.h"
#include "delio/core/increment.h"
#include "generators.h"

namespace {
using namespace delio;
using namespace delio::test;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector6 drawTwist(double metres, double radians) {
    Vector6 twist;
    twist << drawVector(metres), drawVector(radians);
    return twist;
}

Matrix6 drawCovariance() {
    Matrix6 root;
    for (int column = 0; column < 6; ++column) root.col(column) = drawTwist(1, 1);
    return root * root.transpose() + 1e-3 * Matrix6::Identity();
}

RC_GTEST_PROP(Geometry, TheLogarithmGivesTheExponentialsRotationBack, ()) {
    const Vector3d w = drawVector(1.8);  // shorter than pi
    RC_ASSERT((rotationLog(rotationExp(w)) - w).norm() < 1e-9);
    const Matrix3d R = drawPose(0, 180).linear();
    RC_ASSERT((rotationExp(rotationLog(R)) - R).norm() < 1e-7);
}

RC_GTEST_PROP(Geometry, TheLogarithmGivesTheExponentialsPoseBack, ()) {
    const Vector6 twist = drawTwist(100, 1.8);
    RC_ASSERT((poseLog(poseExp(twist)) - twist).norm() < 1e-7);
    RC_ASSERT(difference(poseExp(twist) * poseExp(-twist), Isometry3d::Identity()) < 1e-9);
}

// Half the way and half the way again is the way.
RC_GTEST_PROP(Geometry, AMotionAddsUpOverItsTime, ()) {
    const auto motion = Twist::of(drawPose(10, 40), 0.1);
    const double a = drawReal(1), b = drawReal(1);
    RC_ASSERT(difference(motion.after(a) * motion.after(b), motion.after(a + b)) < 1e-6);
}

RC_GTEST_PROP(Geometry, TheAdjointOfAProductIsTheProductOfAdjoints, ()) {
    const Isometry3d A = drawPose(50, 180), B = drawPose(50, 180);
    RC_ASSERT((adjointOf(A * B) - adjointOf(A) * adjointOf(B)).norm() < 1e-9);
    RC_ASSERT((adjointOf(A) * adjointOf(A.inverse()) - Matrix6::Identity()).norm() < 1e-8);
}

RC_GTEST_PROP(Geometry, ChainingDoesNotDependOnBrackets, ()) {
    const auto draw = [] { return Increment{drawPose(5, 60), drawCovariance()}; };
    const Increment a = draw(), b = draw(), c = draw();
    const Increment left = chained(chained(a, b), c), right = chained(a, chained(b, c));
    RC_ASSERT(difference(left.pose, right.pose) < 1e-9);
    RC_ASSERT((left.covariance - right.covariance).norm() < 1e-9 * left.covariance.norm());
}

// There and back through the sensor's place on the vehicle.
RC_GTEST_PROP(Geometry, TheVehiclesIncrementIsTheSensorsSeenFromElsewhere, ()) {
    const Increment sensor{drawPose(5, 60), drawCovariance()};
    const Isometry3d S = drawPose(3, 180);
    const auto back = ofVehicle(ofVehicle(sensor, S, S), S.inverse(), S.inverse());
    RC_ASSERT(difference(back.pose, sensor.pose) < 1e-9);
    RC_ASSERT((back.covariance - sensor.covariance).norm() < 1e-8 * sensor.covariance.norm());
}

RC_GTEST_PROP(Geometry, ARotationOnceMoreIsTheSameRotation, ()) {
    const Matrix3d R = drawPose(0, 180).linear();
    RC_ASSERT((normalised(R) - R).norm() < 1e-12);
    // What products of thousands of rotations lose.
    Matrix3d worn = R;
    for (int column = 0; column < 3; ++column) worn.col(column) += drawVector(1e-6);
    const Matrix3d mended = normalised(worn);
    RC_ASSERT((mended * mended.transpose() - Matrix3d::Identity()).norm() < 1e-14);
    RC_ASSERT((mended - R).norm() < 1e-5);
}

RC_GTEST_PROP(Geometry, ARotationIsFoundFromWhatItTurns, ()) {
    const Matrix3d R = drawPose(0, 180).linear();
    Matrix3d moment = Matrix3d::Zero();
    const int count = *rc::gen::inRange(3, 30);
    for (int i = 0; i < count; ++i) {
        const Vector3d n = drawVector(1);
        moment += R * n * n.transpose();
    }
    // Two directions are needed, and enough of each.
    const Vector3d spread = Eigen::JacobiSVD<Matrix3d>(moment).singularValues();
    RC_PRE(spread[1] > 1e-3);
    RC_ASSERT((rotationOf(moment) - R).norm() < 1e-6);
}

RC_GTEST_PROP(Geometry, MrptHasTheSamePoses, ()) {
    const Isometry3d A = drawPose(1000, 180), B = drawPose(1000, 180);
    RC_ASSERT(difference(fromMrpt(toMrpt(A)), A) < 1e-9);
    RC_ASSERT(difference(fromMrpt(toMrpt(A) + toMrpt(B)), A * B) < 1e-8);
}
}  // namespace
