#include "paper/pattern_registration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::Pattern;
using paper::registerPatterns;
using test::degreesBetween;
using test::rotationAbout;

constexpr double kDeg = M_PI / 180;

Pattern patternOf(const Eigen::Matrix3Xd& directions) {
    return {directions.cast<float>(), Eigen::VectorXf::Ones(directions.cols()),
            static_cast<std::size_t>(directions.cols()), 0};
}

/** Normals about each of `axes`, off by some `spread_deg`. */
Eigen::Matrix3Xd blobs(const std::vector<Eigen::Vector3d>& axes, Eigen::Index each,
                       double spread_deg, test::Noise& noise) {
    Eigen::Matrix3Xd directions(3, each * static_cast<Eigen::Index>(axes.size()));
    Eigen::Index i = 0;
    for (const auto& axis : axes)
        for (Eigen::Index k = 0; k < each; ++k)
            directions.col(i++) = (axis + spread_deg * kDeg * noise.normals()).normalized();
    return directions;
}

/** The same surfaces seen again: each normal off by a further `noise_deg`. */
Eigen::Matrix3Xd seenAgain(const Eigen::Matrix3Xd& directions, double noise_deg,
                           test::Noise& noise) {
    Eigen::Matrix3Xd again = directions;
    for (Eigen::Index i = 0; i < again.cols(); ++i)
        again.col(i) = (again.col(i) + noise_deg * kDeg * noise.normals()).normalized();
    return again;
}

/** Not the grid's own axes. */
std::vector<Eigen::Vector3d> threeAxes() {
    const Eigen::Matrix3d R = rotationAbout({1, 2, 3}, 35);
    return {R.col(0), R.col(1), R.col(2)};
}

PatternRegistrationOptions nearest() {
    PatternRegistrationOptions options;
    options.kernel_deg = 0;
    return options;
}

bool isCovariance(const Eigen::Matrix3d& m) {
    return m.allFinite() && (m - m.transpose()).norm() <= 1e-12 * m.norm() &&
           m.llt().info() == Eigen::Success;
}

bool isRotation(const Eigen::Matrix3d& R) {
    return (R * R.transpose()).isIdentity(1e-9) && R.determinant() > 0;
}

// 4500 normals of 0.3 deg noise in each scan allow about 0.3 sqrt(2) / sqrt(3000), 0.008 deg, about
// each axis; the blobs, which have no structure finer than 3 deg, and cells that differ between the
// scans cost the rest.
TEST(PatternRegistration, FindsRotationsAboutEachAxisFromWrongStarts) {
    test::Noise noise;
    PatternRegistrationOptions options;
    options.last_kernel_deg = 2;
    const auto normals = blobs(threeAxes(), 1500, 3, noise);
    for (int axis = 0; axis < 3; ++axis)
        for (const double degrees : {-3.0, 1.5}) {
            const Eigen::Matrix3d truth = rotationAbout(Eigen::Vector3d::Unit(axis), degrees);
            const auto from = patternOf(seenAgain(normals, 0.3, noise));
            const auto to = patternOf(truth.transpose() * seenAgain(normals, 0.3, noise));
            const Eigen::Matrix3d starts[] = {truth * rotationAbout(noise.direction(), 3),
                                              Eigen::Matrix3d::Identity()};
            for (const auto& start : starts) {
                const auto found = registerPatterns(from, to, start, options);
                EXPECT_TRUE(found.valid);
                EXPECT_TRUE(isRotation(found.rotation));
                EXPECT_LT(degreesBetween(found.rotation, truth), 0.05);
                EXPECT_EQ(found.unobservedAxes.cols(), 0);
                EXPECT_GT(found.observability.minCoeff(), 0.6);
                EXPECT_LE(found.observability.maxCoeff(), 1.0);
                EXPECT_TRUE(isCovariance(found.covariance));
            }
        }
}

TEST(PatternRegistration, OneLargeRotationWithAGoodPrediction) {
    test::Noise noise;
    const auto normals = blobs(threeAxes(), 1500, 3, noise);
    const Eigen::Matrix3d truth = rotationAbout({1, -1, 2}, 140);
    for (const auto& options : {PatternRegistrationOptions{}, nearest()}) {
        const auto found =
            registerPatterns(patternOf(normals), patternOf(truth.transpose() * normals),
                             truth * rotationAbout({0, 1, 0}, 0.02), options);
        EXPECT_LT(degreesBetween(found.rotation, truth), 0.05);
    }
}

// Why the kernel is there: inside a dense blob every normal has a partner beside itself.
TEST(PatternRegistration, NearestNeighboursHardlyLeaveTheirStartWhereTheKernelDoes) {
    test::Noise noise;
    const auto normals = blobs(threeAxes(), 1500, 3, noise);
    const auto from = patternOf(seenAgain(normals, 0.5, noise)),
               to = patternOf(seenAgain(normals, 0.5, noise));
    const Eigen::Matrix3d start = rotationAbout({1, 1, 0}, 2);
    const Eigen::Matrix3d truth = Eigen::Matrix3d::Identity();
    const double kernel = degreesBetween(registerPatterns(from, to, start, {}).rotation, truth);
    const double near =
        degreesBetween(registerPatterns(from, to, start, nearest()).rotation, truth);
    EXPECT_LT(kernel, 0.05);
    EXPECT_GT(near, 4 * kernel);
    EXPECT_LT(near, 2);
}

// Normals farther from each other than the start is from the truth: nothing to choose.
TEST(PatternRegistration, NearestNeighboursOfASparsePatternAreExact) {
    Eigen::Matrix3Xd normals(3, 60);
    for (int i = 0; i < 60; ++i) {  // Fibonacci's lattice: some 25 deg apart
        const double z = (i + 0.5) / 30 - 1, azimuth = i * 2.399963;
        normals.col(i) << std::sqrt(1 - z * z) * std::cos(azimuth),
            std::sqrt(1 - z * z) * std::sin(azimuth), z;
    }
    const Eigen::Matrix3d truth = rotationAbout({3, 1, 2}, 5);
    const auto found = registerPatterns(patternOf(normals), patternOf(truth.transpose() * normals),
                                        Eigen::Matrix3d::Identity(), nearest());
    EXPECT_TRUE(found.valid);
    EXPECT_EQ(found.matches, 60U);
    EXPECT_LT(degreesBetween(found.rotation, truth), 1e-4);  // floats
    EXPECT_LT(found.residual_rad, 1e-6);
    EXPECT_LE(found.iterations, 5U);
}

// 30 % of each pattern lies anywhere on the sphere, and not where it lies in the other one.
TEST(PatternRegistration, OutliersDoNotPull) {
    test::Noise noise;
    const auto normals = blobs(threeAxes(), 1500, 3, noise);
    const Eigen::Matrix3d truth = rotationAbout({1, 2, -1}, 2.5);
    Eigen::Matrix3Xd from = seenAgain(normals, 0.5, noise);
    Eigen::Matrix3Xd to = truth.transpose() * seenAgain(normals, 0.5, noise);
    for (Eigen::Index i = 0; i < from.cols(); ++i) {
        if (i % 10 < 3) from.col(i) = noise.direction();
        if ((i + 5) % 10 < 3) to.col(i) = noise.direction();
    }
    const auto found =
        registerPatterns(patternOf(from), patternOf(to), Eigen::Matrix3d::Identity(), {});
    EXPECT_TRUE(found.valid);
    // What odometry is asked for; without weights by density, a degree would remain.
    EXPECT_LT(degreesBetween(found.rotation, truth), 0.2);
}

TEST(PatternRegistration, WeightsAreHeeded) {
    test::Noise noise;
    const auto normals = blobs(threeAxes(), 500, 3, noise);
    const Eigen::Matrix3d truth = rotationAbout({0, 0, 1}, 1), wrong = rotationAbout({0, 0, 1}, -2);
    Eigen::Matrix3Xd from(3, 3000), to(3, 3000);
    from << normals, normals;
    to << truth.transpose() * normals, wrong.transpose() * normals;
    Pattern first = patternOf(from), second = patternOf(to);
    second.weights.tail(1500).setConstant(1e-3F);
    const auto found = registerPatterns(first, second, Eigen::Matrix3d::Identity(), {});
    EXPECT_LT(degreesBetween(found.rotation, truth), 0.05);
}

// The ground alone: nothing says how far the vehicle turned about the vertical axis.
TEST(PatternRegistration, AnAxisThatIsNotObservedKeepsThePrediction) {
    test::Noise noise;
    const Eigen::Matrix3d tilted = rotationAbout({1, 0.5, 0}, 1.5);
    const auto ground = blobs({{0, 0, 1}}, 4000, 1, noise);
    const Eigen::Matrix3d predicted = rotationAbout({0, 0, 1}, 2);
    for (auto options : {PatternRegistrationOptions{}, nearest()}) {
        options.prior_sigma_deg = 0.7;
        const auto found = registerPatterns(patternOf(ground),
                                            patternOf((tilted * predicted).transpose() * ground),
                                            predicted, options);
        EXPECT_TRUE(found.valid);
        ASSERT_EQ(found.unobservedAxes.cols(), 1);
        // In frame `to`, where the ground's normal is turned by R'.
        const Eigen::Vector3d axis = found.unobservedAxes.col(0);
        const Eigen::Vector3d vertical =
            (tilted * predicted).transpose() * Eigen::Vector3d(0, 0, 1);
        EXPECT_NEAR(std::abs(axis.dot(vertical)), 1, 1e-4);
        EXPECT_LT(found.observability[0], 0.01);
        EXPECT_GT(found.observability[1], 0.9);
        const Eigen::AngleAxisd moved(predicted.transpose() * found.rotation);
        EXPECT_LT(std::abs(moved.angle() * moved.axis().dot(axis)), 1e-9);
        EXPECT_NEAR(axis.dot(found.covariance * axis), std::pow(0.7 * kDeg, 2), 1e-12);
        EXPECT_TRUE(isCovariance(found.covariance));
        // The other two are known far better.
        EXPECT_LT(found.covariance.trace(), 1.2 * std::pow(0.7 * kDeg, 2));
        // The kernel finds the tilt all the same; nearest neighbours only go some of the way.
        if (options.kernel_deg == 0) continue;
        EXPECT_LT(std::acos((found.rotation * vertical).z()) / kDeg, 0.1);
    }
}

TEST(PatternRegistration, WithTooFewNormalsThePredictionStays) {
    test::Noise noise;
    const auto many = patternOf(blobs(threeAxes(), 100, 3, noise));
    const auto few = patternOf(blobs(threeAxes(), 16, 3, noise));  // 48 of 50
    const Pattern none = patternOf(Eigen::Matrix3Xd(3, 0));
    const Eigen::Matrix3d predicted = rotationAbout({1, 1, 1}, 4);
    for (const auto& options : {PatternRegistrationOptions{}, nearest()})
        for (const auto& [from, to] :
             {std::pair(many, few), std::pair(few, many), std::pair(none, many),
              std::pair(many, none), std::pair(none, none)}) {
            const auto found = registerPatterns(from, to, predicted, options);
            EXPECT_FALSE(found.valid);
            EXPECT_EQ(found.rotation, predicted);
            EXPECT_EQ(found.unobservedAxes.cols(), 3);
            EXPECT_TRUE(isCovariance(found.covariance));
            EXPECT_NEAR(found.covariance.trace(), 3 * kDeg * kDeg, 1e-12);
        }
}

// Nothing of one pattern lies near anything of the other.
// Ground and a wall that seems to have turned by 40 deg: no vehicle does that within a scan.
TEST(PatternRegistration, ARotationFarFromThePredictionIsNotBelieved) {
    test::Noise noise;
    PatternRegistrationOptions options;
    options.kernel_deg = 40;
    const auto normals = blobs(threeAxes(), 500, 3, noise);
    const Eigen::Matrix3d truth = rotationAbout(threeAxes()[0], 40);
    const auto from = patternOf(normals), to = patternOf(truth.transpose() * normals);
    const Eigen::Matrix3d start = Eigen::Matrix3d::Identity();
    const auto refused = registerPatterns(from, to, start, options);
    EXPECT_FALSE(refused.valid);
    EXPECT_TRUE(refused.tooFar);
    EXPECT_EQ(refused.rotation, start);
    EXPECT_TRUE(isCovariance(refused.covariance));
    options.max_correction_deg = 180;
    const auto believed = registerPatterns(from, to, start, options);
    EXPECT_TRUE(believed.valid);
    EXPECT_FALSE(believed.tooFar);
    EXPECT_LT(degreesBetween(believed.rotation, truth), 0.1);
}

TEST(PatternRegistration, PatternsThatDoNotMeetKeepThePrediction) {
    test::Noise noise;
    const auto up = patternOf(blobs({{0, 0, 1}}, 2000, 3, noise));
    const auto ahead = patternOf(blobs({{1, 0, 0}}, 2000, 3, noise));
    const auto found = registerPatterns(up, ahead, rotationAbout({0, 0, 1}, 1), {});
    EXPECT_FALSE(found.valid);
    EXPECT_EQ(found.rotation, rotationAbout({0, 0, 1}, 1));
    EXPECT_TRUE(isCovariance(found.covariance));
}

TEST(PatternRegistration, IdenticalPatternsDoNotTurn) {
    test::Noise noise;
    const auto pattern = patternOf(blobs(threeAxes(), 500, 3, noise));
    for (const auto& options : {PatternRegistrationOptions{}, nearest()}) {
        const auto found = registerPatterns(pattern, pattern, Eigen::Matrix3d::Identity(), options);
        EXPECT_TRUE(found.valid);
        EXPECT_LT(degreesBetween(found.rotation, Eigen::Matrix3d::Identity()), 1e-3);
        EXPECT_TRUE(isCovariance(found.covariance)) << found.covariance;
    }
}

// A room without noise: thousands of normals, and only three directions.
TEST(PatternRegistration, NormalsThatCoincideStillCount) {
    Eigen::Matrix3Xd normals(3, 3000);
    for (Eigen::Index i = 0; i < 3000; ++i)
        normals.col(i) = threeAxes()[static_cast<size_t>(i % 3)];
    const Eigen::Matrix3d truth = rotationAbout({1, 2, -1}, 2.5);
    for (const auto& options : {PatternRegistrationOptions{}, nearest()}) {
        const auto found =
            registerPatterns(patternOf(normals), patternOf(truth.transpose() * normals),
                             Eigen::Matrix3d::Identity(), options);
        EXPECT_TRUE(found.valid);
        EXPECT_LT(degreesBetween(found.rotation, truth), 1e-3);
        EXPECT_TRUE(isCovariance(found.covariance)) << found.covariance;
    }
}

TEST(PatternRegistration, MoreNormalsGiveASmallerCovariance) {
    test::Noise noise;
    for (const auto& options : {PatternRegistrationOptions{}, nearest()}) {
        double before = 1;
        for (const Eigen::Index each : {40, 160, 640}) {
            const auto normals = blobs(threeAxes(), each, 4, noise);
            const auto found = registerPatterns(patternOf(seenAgain(normals, 1, noise)),
                                                patternOf(seenAgain(normals, 1, noise)),
                                                Eigen::Matrix3d::Identity(), options);
            EXPECT_TRUE(isCovariance(found.covariance));
            EXPECT_LT(found.covariance.trace(), before);
            before = found.covariance.trace();
        }
    }
}

TEST(PatternRegistration, OnlyNormalsNearTheSpinAxisAreGround) {
    const Eigen::Vector3f up = Eigen::Vector3f(0.1F, -0.2F, 1).normalized();
    const Eigen::Vector3f across = up.unitOrthogonal();
    const auto tilted = [&](float deg) {
        const float angle = deg * static_cast<float>(kDeg);
        return Eigen::Vector3f(std::cos(angle) * up + std::sin(angle) * across);
    };
    Pattern pattern;
    pattern.directions.resize(3, 5);
    pattern.directions << tilted(0), tilted(24), tilted(26), -tilted(24), across;
    pattern.weights = Eigen::VectorXf::Constant(5, 0.8F);
    PatternRegistrationOptions options;
    options.ground_weight = 0.25;
    paper::weighGround(pattern, up, options);
    const auto expected = (Eigen::VectorXf(5) << 0.2F, 0.2F, 0.8F, 0.2F, 0.8F).finished();
    EXPECT_LT((pattern.weights - expected).cwiseAbs().maxCoeff(), 1e-6F);
}

// The road bends under a vehicle that pitches with it: walls turn, the visible ground does not.
TEST(PatternRegistration, WallsGiveThePitchWhereTheGroundMovesAlong) {
    test::Noise noise;
    const Eigen::Matrix3d truth = rotationAbout({0, 1, 0}, 0.4);
    const auto walls = blobs({{1, 0, 0}, {0, 1, 0}}, 500, 1, noise);
    const auto ground = blobs({{0, 0, 1}}, 2000, 1, noise);
    const auto errorAt = [&](double weight) {
        PatternRegistrationOptions options;
        options.ground_weight = weight;
        Eigen::Matrix3Xd before(3, 3000), now(3, 3000);
        before << walls, ground;
        now << truth.transpose() * walls, ground;
        Pattern from = patternOf(before), to = patternOf(now);
        paper::weighGround(from, Eigen::Vector3f::UnitZ(), options);
        paper::weighGround(to, Eigen::Vector3f::UnitZ(), options);
        return degreesBetween(
            registerPatterns(from, to, Eigen::Matrix3d::Identity(), options).rotation, truth);
    };
    EXPECT_GT(errorAt(1), 0.3);
    EXPECT_LT(errorAt(0.1), 0.1);
}
}  // namespace
