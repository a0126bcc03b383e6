#include "odometry/inertial.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "delio/core/geometry.h"

namespace delio::odometry {
namespace {
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kDeg = M_PI / 180, kScan_s = 0.1;

/** LiDAR to world at a time. */
using Attitude = std::function<Matrix3d(double)>;

Attitude constantRate(const Vector3d& rate) {
    return [rate](double time_s) { return rotationExp(rate * time_s); };
}

/** A hand: 15 deg about each axis at about 1.5 Hz. */
Matrix3d swing(double time_s) {
    const double phase = 2 * M_PI * time_s;
    return rotationExp(
        15 * kDeg *
        Vector3d(std::sin(1.5 * phase), std::sin(1.6 * phase + 1), std::sin(1.4 * phase + 2)));
}

/** A gyroscope on the LiDAR, and scans that are registered. */
struct Rig {
    Attitude attitude = swing;
    Matrix3d mount = Matrix3d::Identity();  //!< IMU to LiDAR
    Vector3d bias = Vector3d::Zero();       //!< rad/s, IMU's axes
    double offset_s = 0;                    //!< stamps of the IMU are late by this
    double rate_hz = 200;
    double rateNoise = 0.1 * kDeg;     //!< of a sample, rad/s
    double turnNoise = 0.1 * kDeg;     //!< of a registered attitude, rad
    std::optional<Matrix3d> recorded;  //!< IMU to vehicle, as the samples say
    /** Damage to a sample; false: it is lost. */
    std::function<bool(double, ImuSample&)> spoil = [](double, ImuSample&) { return true; };

    GyroPrior gyro{};
    std::mt19937 random{7};
    std::size_t samples = 0, scans = 0;
    Matrix3d latest = Matrix3d::Identity();  //!< registered

    Vector3d noise(double sigma) {
        std::normal_distribution<double> normal(0, sigma);
        const double x = normal(random), y = normal(random), z = normal(random);
        return {x, y, z};
    }

    void addUntil(double time_s) {
        constexpr double kHalf_s = 1e-4;
        for (;; ++samples) {
            const double at_s = static_cast<double>(samples) / rate_hz - 0.2;
            if (at_s > time_s) return;
            const Matrix3d moved = attitude(at_s - kHalf_s).transpose() * attitude(at_s + kHalf_s);
            ImuSample sample;
            sample.stamp_s = 1000 + at_s + offset_s;
            sample.rate_radps =
                mount.transpose() * rotationLog(moved) / (2 * kHalf_s) + bias + noise(rateNoise);
            if (recorded) sample.sensorPose = isometry(*recorded, Vector3d::Zero());
            if (spoil(at_s, sample)) gyro.add(sample);
        }
    }

    double now_s() const { return kScan_s * static_cast<double>(scans); }

    void scan() {
        addUntil(now_s() + 0.3);
        gyro.advance({now_s(), 1000 + now_s(), 0.05}, Isometry3d::Identity());
        gyro.count(gyro.isTrusted() && gyro.rotation(now_s() - kScan_s, now_s()));
        const Matrix3d registered = attitude(now_s()) * rotationExp(noise(turnNoise));
        if (scans > 0) gyro.observe(now_s() - kScan_s, now_s(), latest.transpose() * registered);
        latest = registered;
        ++scans;
    }
    void drive(std::size_t number) {
        for (std::size_t i = 0; i < number; ++i) scan();
    }

    /** Degrees between the predicted and the true rotation, the worst over the next scans. */
    double worstOver(std::size_t number) {
        double worst = 0;
        for (std::size_t i = 0; i < number; ++i) {
            scan();
            const double to_s = now_s() - kScan_s, from_s = to_s - kScan_s;
            const auto predicted = gyro.rotation(from_s, to_s);
            if (!predicted) return INFINITY;
            const Matrix3d truth = attitude(from_s).transpose() * attitude(to_s);
            worst = std::max(worst, angleOf(truth.transpose() * *predicted) / kDeg);
        }
        return worst;
    }

    ImuReport report() const { return gyro.report().value(); }
};

double degreesBetween(const Matrix3d& a, const Matrix3d& b) {
    return angleOf(a.transpose() * b) / kDeg;
}

bool says(const ImuReport& report, const std::string& words) {
    for (const auto& line : report.findings)
        if (line.find(words) != std::string::npos) return true;
    return false;
}

const Matrix3d kMounted = rotationExp(Vector3d(0.4, -0.3, 1.2));

TEST(Gyro, GivesTheRotationOfAConstantRate) {
    Rig rig;
    const Vector3d rate(0.2, -0.5, 0.9);
    rig.attitude = constantRate(rate);
    rig.recorded = Matrix3d::Identity();
    rig.rateNoise = rig.turnNoise = 0;
    rig.drive(3);
    const auto turned = rig.gyro.rotation(0.013, 0.157);
    ASSERT_TRUE(turned);
    EXPECT_LT(degreesBetween(*turned, rotationExp(0.144 * rate)), 1e-6);
    const auto back = rig.gyro.rotation(0.157, 0.013);
    EXPECT_LT(degreesBetween(*back, turned->transpose()), 1e-6);
    const auto path =
        rig.gyro.trajectory(Isometry3d::Identity(), Vector3d(1, 0, 0), 0.1, -0.05, 0.05);
    ASSERT_TRUE(path);
    EXPECT_LT(degreesBetween(path->at(0.03).linear(), rotationExp(0.03 * rate)), 1e-6);
    EXPECT_NEAR(path->at(0.03).translation().x(), 0.03, 1e-9);
    const auto reversed = rig.gyro.reversed().rotation(-0.157, -0.013);
    EXPECT_LT(degreesBetween(*reversed, turned->transpose()), 1e-6);
}

TEST(Gyro, IsTrustedAfterMotionThatItExplains) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.drive(4);
    EXPECT_FALSE(rig.gyro.isTrusted());
    rig.drive(8);
    EXPECT_TRUE(rig.gyro.isTrusted());
    EXPECT_LT(rig.worstOver(40), 0.15);
}

TEST(Gyro, IsNotTrustedWhileNothingTurns) {
    Rig rig;
    rig.attitude = constantRate(Vector3d::Zero());
    rig.recorded = Matrix3d::Identity();
    rig.drive(60);
    EXPECT_FALSE(rig.gyro.isTrusted());
    EXPECT_TRUE(says(rig.report(), "turned too little"));
}

TEST(Gyro, SamplesOfAnotherClockAreNamed) {
    for (const double offset_s : {-5000.0, 5000.0}) {
        Rig rig;
        rig.recorded = Matrix3d::Identity();
        rig.offset_s = offset_s;
        rig.drive(60);
        EXPECT_FALSE(rig.gyro.isTrusted());
        EXPECT_TRUE(says(rig.report(), "none of its samples lies between two scans")) << offset_s;
    }
}

TEST(Gyro, FindsABiasOfTwoDegreesASecond) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.bias = Vector3d(2, -2, 2) * kDeg;
    rig.drive(60);
    EXPECT_LT((rig.report().bias_radps - rig.bias).norm(), 0.1 * kDeg);
    EXPECT_LT(rig.worstOver(40), 0.15);
}

TEST(Gyro, CalibratesOrientationAndOffset) {
    for (const double offset_s : {-0.035, 0.0, 0.02}) {
        Rig rig;
        rig.mount = kMounted;
        rig.offset_s = offset_s;
        rig.bias = Vector3d(0.5, -0.5, 0.5) * kDeg;
        rig.drive(300);
        const ImuReport report = rig.report();
        EXPECT_TRUE(rig.gyro.isTrusted());
        ASSERT_TRUE(report.rotation && report.rotationSigma_rad && report.offsetSigma_s);
        EXPECT_LT(degreesBetween(*report.rotation, kMounted), 0.2);
        EXPECT_LT(*report.rotationSigma_rad, 0.2 * kDeg);
        EXPECT_NEAR(report.offset_s, offset_s, 2e-3);
        EXPECT_LT(*report.offsetSigma_s, 2e-3);
        EXPECT_LT(rig.worstOver(40), 0.3);
    }
}

TEST(Gyro, ItsPrecisionIsThatOfRepeatedDraws) {
    double squares = 0, sigma = 0;
    constexpr unsigned kDraws = 20;
    for (unsigned draw = 0; draw < kDraws; ++draw) {
        Rig rig;
        rig.random.seed(100 + draw);
        rig.mount = kMounted;
        rig.turnNoise = 0.3 * kDeg;
        rig.drive(100);
        const ImuReport report = rig.report();
        ASSERT_TRUE(report.rotation && report.rotationSigma_rad);
        squares += std::pow(degreesBetween(*report.rotation, kMounted) * kDeg, 2) / 3;
        sigma += *report.rotationSigma_rad / kDraws;
    }
    const double found = std::sqrt(squares / kDraws);
    EXPECT_GT(sigma, 0.5 * found);
    EXPECT_LT(sigma, 3 * found);
}

TEST(Gyro, CalibratesWhereTheRecordedOrientationIsWrong) {
    Rig rig;
    rig.mount = kMounted;
    rig.recorded = Matrix3d::Identity();
    rig.drive(20);
    EXPECT_TRUE(!rig.gyro.isTrusted() || rig.report().rotation != rig.recorded);
    rig.drive(40);
    EXPECT_TRUE(rig.gyro.isTrusted());
    EXPECT_LT(degreesBetween(*rig.report().rotation, kMounted), 0.3);
    EXPECT_TRUE(says(rig.report(), "orientation in the recording is off"));
}

TEST(Gyro, TurnsAboutOneAxisDoNotCalibrateIt) {
    Rig rig;
    rig.attitude = [](double time_s) {
        return rotationExp(Vector3d(0, 0, 0.5 * std::sin(time_s)));
    };
    rig.mount = kMounted;
    rig.drive(200);
    EXPECT_FALSE(rig.gyro.isTrusted());
    EXPECT_FALSE(rig.gyro.rotation(19, 19.1));
}

TEST(Gyro, SamplesCountByTheirStamps) {
    Rig inOrder, shuffled;
    std::vector<ImuSample> held;
    shuffled.spoil = [&](double, ImuSample& sample) {
        held.push_back(sample);
        if (held.size() < 7) return false;
        for (auto each = held.rbegin(); each != held.rend(); ++each) shuffled.gyro.add(*each);
        held.clear();
        return false;
    };
    for (Rig* rig : {&inOrder, &shuffled}) {
        rig->recorded = Matrix3d::Identity();
        rig->drive(30);
    }
    EXPECT_EQ(shuffled.report().dropped, 0U);
    const auto a = inOrder.gyro.rotation(2.8, 2.9), b = shuffled.gyro.rotation(2.8, 2.9);
    ASSERT_TRUE(a && b);
    EXPECT_TRUE(*a == *b);
}

TEST(Gyro, GapsAreNamedAndNotBridged) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.spoil = [](double at_s, ImuSample&) { return at_s < 3 || at_s > 3.5; };
    rig.drive(29);
    EXPECT_TRUE(rig.gyro.isTrusted());
    rig.drive(5);
    EXPECT_FALSE(rig.gyro.rotation(3.2, 3.3));
    rig.drive(10);
    EXPECT_FALSE(rig.gyro.rotation(2.95, 3.55));
    EXPECT_TRUE(rig.gyro.isTrusted());
    EXPECT_LT(rig.worstOver(20), 0.15);
    EXPECT_TRUE(says(rig.report(), "no IMU samples for "));
}

TEST(Gyro, AFrozenRateIsNotUsed) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.spoil = [](double at_s, ImuSample& sample) {
        if (at_s > 3) sample.rate_radps = Vector3d(0.1, 0.2, 0.3);
        return true;
    };
    rig.drive(29);
    EXPECT_TRUE(rig.gyro.isTrusted());
    rig.drive(20);
    EXPECT_FALSE(rig.gyro.rotation(4.6, 4.7));
    EXPECT_TRUE(says(rig.report(), "frozen"));
}

TEST(Gyro, ContradictionEndsTheTrust) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.spoil = [](double at_s, ImuSample& sample) {
        if (at_s > 3) sample.rate_radps *= 3;
        return true;
    };
    rig.drive(29);
    EXPECT_TRUE(rig.gyro.isTrusted());
    rig.drive(40);
    EXPECT_FALSE(rig.gyro.isTrusted());
    EXPECT_TRUE(says(rig.report(), "contradicts the scans"));
}

TEST(Gyro, ASaturatedRateIsNotTrustedWhereItMatters) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.spoil = [](double, ImuSample& sample) {
        sample.rate_radps = sample.rate_radps.cwiseMin(30 * kDeg).cwiseMax(-30 * kDeg);
        return true;
    };
    rig.drive(100);
    EXPECT_FALSE(rig.gyro.isTrusted());
    EXPECT_TRUE(says(rig.report(), "not used"));
}

TEST(Gyro, NamesDegreesASecond) {
    Rig rig;
    rig.spoil = [](double, ImuSample& sample) {
        sample.rate_radps /= kDeg;
        return true;
    };
    rig.drive(100);
    EXPECT_FALSE(rig.gyro.isTrusted());
    EXPECT_TRUE(says(rig.report(), "deg/s"));
}

TEST(Gyro, NamesMirroredAxes) {
    Rig rig;
    rig.spoil = [](double, ImuSample& sample) {
        sample.rate_radps.y() *= -1;
        return true;
    };
    rig.drive(100);
    EXPECT_FALSE(rig.gyro.isTrusted());
    EXPECT_TRUE(says(rig.report(), "mirrored"));
}

TEST(Gyro, SwappedAxesAreARotation) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.spoil = [](double, ImuSample& sample) {
        sample.rate_radps =
            Vector3d(sample.rate_radps.y(), sample.rate_radps.z(), sample.rate_radps.x());
        return true;
    };
    rig.drive(60);
    EXPECT_TRUE(rig.gyro.isTrusted());
    EXPECT_LT(rig.worstOver(20), 0.3);
}

TEST(Gyro, IgnoresSamplesThatSayNothing) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    rig.spoil = [&](double at_s, ImuSample& sample) {
        if (at_s > 1 && at_s < 1.1) sample.rate_radps.x() = std::nan("");
        if (at_s > 1.5 && at_s < 1.6) rig.gyro.add(sample);  // twice
        if (at_s > 2 && at_s < 2.02) sample.stamp_s = std::nan("");
        if (at_s > 3 && at_s < 3.02) sample.rate_radps.y() = 1e300;
        return true;
    };
    rig.drive(60);
    EXPECT_TRUE(rig.gyro.isTrusted());
    EXPECT_GT(rig.report().dropped, 30U);
    EXPECT_TRUE(says(rig.report(), "are ignored"));
    EXPECT_LT(rig.worstOver(20), 0.15);
}

TEST(Gyro, TheRateOfItsSamplesMayChange) {
    Rig rig;
    rig.recorded = Matrix3d::Identity();
    std::size_t number = 0;
    rig.spoil = [&](double at_s, ImuSample&) { return at_s < 2 || ++number % 4 == 0; };
    rig.drive(30);
    EXPECT_TRUE(rig.gyro.isTrusted());
    EXPECT_LT(rig.worstOver(20), 0.3);
    EXPECT_EQ(rig.report().scansWithout, 0U);
}

TEST(Gyro, ManySamplesThatWaitAreBounded) {
    GyroPrior gyro;
    ImuSample sample;
    sample.rate_radps.setZero();
    for (int i = 0; i < 200'100; ++i) {
        sample.stamp_s = 1e-3 * i;
        gyro.add(sample);
    }
    EXPECT_EQ(gyro.report().value().dropped, 100U);
}
}  // namespace
}  // namespace delio::odometry
