#include "paper/line_registration.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "ring_scan.h"

namespace {
using namespace delio;
using paper::closestPoints;
using paper::LineCloud;
using paper::registerLines;
using paper::searchTranslation;

/** Lines of a scan taken at a place in a scene, all in the scene's axes; a draw of its own for each
 *  place, as odometry does it. */
LineCloud linesAt(const test::Scene& scene, const Eigen::Vector3d& place, double noise_m = 0) {
    // Turned, so that neither rings nor sectors lie along the walls.
    const auto pose = test::poseAt(place.x(), place.y(), place.z(), 0.4);
    LineCloudOptions options;
    test::Noise noise(static_cast<std::uint32_t>(1e4 + 1e3 * (place.x() + place.y())));
    options.seed = static_cast<std::uint32_t>(1e4 + 1e3 * (place.x() + place.y() + place.z()));
    const auto scan = test::ringScan(scene, pose, {40, 540, -24, 14, noise_m}, noise);
    return paper::rotated(paper::drawLines(scan.points, scan.rings, options), pose.linear());
}

LineRegistrationOptions withCentroids(unsigned iterations) {
    LineRegistrationOptions options;
    options.centroids = true;
    options.max_iterations = iterations;
    options.converged = 1e-5;
    return options;
}

bool isCovariance(const Eigen::Matrix3d& m) {
    return m.allFinite() && (m - m.transpose()).norm() <= 1e-12 * m.norm() &&
           m.llt().info() == Eigen::Success;
}

/** Smallest distance of two lines by nested golden-section searches. */
double distanceBySearch(const Eigen::Vector3d& P, const Eigen::Vector3d& u,
                        const Eigen::Vector3d& Q, const Eigen::Vector3d& v) {
    const auto minimum = [](double from, double to, const auto& f) {
        const double g = (std::sqrt(5.0) - 1) / 2;
        for (int i = 0; i < 90; ++i) {
            const double a = to - g * (to - from), b = from + g * (to - from);
            (f(a) < f(b) ? to : from) = f(a) < f(b) ? b : a;
        }
        return f((from + to) / 2);
    };
    return minimum(-500, 500, [&](double s) {
        const Eigen::Vector3d p = P + s * u;
        return minimum(-500, 500, [&](double t) { return (p - Q - t * v).norm(); });
    });
}

TEST(ClosestPoints, AreWhereASearchFindsThem) {
    test::Noise noise;
    for (int round = 0; round < 60; ++round) {
        const Eigen::Vector3d P = 5 * noise.normals(), Q = 5 * noise.normals();
        const Eigen::Vector3d u = noise.direction() * (1 + noise.uniform() / 2);
        // From any direction to some 2 deg beside u.
        const double width = round % 3 == 0 ? 10 : round % 3 == 1 ? 0.3 : 0.06;
        const Eigen::Vector3d v = u + width * noise.direction();
        const double sine = u.normalized().cross(v.normalized()).norm();
        if (sine < 0.02) continue;
        const auto found = closestPoints(P, u, Q, v, 0.5);
        ASSERT_FALSE(found.parallel);
        // On the lines, each,
        EXPECT_LT((found.onSource - P).cross(u).norm() / u.norm(), 1e-9);
        EXPECT_LT((found.onTarget - Q).cross(v).norm() / v.norm(), 1e-9);
        // and as near to each other as lines can be.
        const Eigen::Vector3d d = found.onTarget - found.onSource;
        EXPECT_LT(std::abs(d.dot(u)), 1e-9);
        EXPECT_LT(std::abs(d.dot(v)), 1e-9);
        EXPECT_NEAR(d.norm(), distanceBySearch(P, u, Q, v), 1e-6);
    }
}

TEST(ClosestPoints, OfParallelLinesNothingIsDivided) {
    const Eigen::Vector3d P(1, 2, 3), Q(0, 0, 1), u(0, 0, 2);
    for (const Eigen::Vector3d& v :
         {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0, 0, -5), Eigen::Vector3d(1e-9, 0, 1)}) {
        const auto found = closestPoints(P, u, Q, v, 0.01);
        EXPECT_TRUE(found.parallel);
        EXPECT_EQ(found.onSource, P);
        EXPECT_LT((found.onTarget - Eigen::Vector3d(0, 0, 3)).norm(), 1e-7);
    }
}

TEST(ClosestPoints, TheAngleThatCountsAsParallelIsTheOptions) {
    for (const double degrees : {1.0, 15.0, 60.0})
        for (const double sign : {-1.0, 1.0}) {
            const auto parallelAt = [&](double angle) {
                const Eigen::Vector3d v =
                    test::rotationAbout({0, 1, 0}, sign * angle) * Eigen::Vector3d(0, 0, 3);
                return closestPoints({1, 2, 3}, {0, 0, 2}, {0, 0, 0}, v, degrees).parallel;
            };
            EXPECT_TRUE(parallelAt(degrees - 0.01));
            EXPECT_FALSE(parallelAt(degrees + 0.01));
            EXPECT_TRUE(parallelAt(180 - degrees + 0.01));
        }
}

// Without noise, what is left is what pairs on two surfaces do: less than a millimetre. From half a
// metre off, pairs are as often wrong as right, and one start in sixteen ended elsewhere.
TEST(LineRegistration, FindsPlantedTranslations) {
    const auto from = linesAt(test::room(), {0, 0, 0});
    test::Noise noise;
    int farStarts = 0, found = 0;
    for (const Eigen::Vector3d& truth :
         {Eigen::Vector3d(0.7, 0, 0), Eigen::Vector3d(1.2, -0.4, 0.1), Eigen::Vector3d(-0.5, 1, 0),
          Eigen::Vector3d(0.02, 0, 0)}) {
        const auto to = linesAt(test::room(), truth);
        for (const double off : {0.0, 0.1, 0.2, 0.2, 0.5, 0.5, 0.5, 0.5}) {
            const Eigen::Vector3d start = truth + off * noise.direction();
            const auto estimate = registerLines(from, to, start, {});
            const double error = (estimate.translation - truth).norm();
            farStarts += off == 0.5;
            found += off == 0.5 && error < 0.01;
            EXPECT_TRUE(estimate.valid);
            EXPECT_TRUE(isCovariance(estimate.covariance));
            if (off == 0.5) continue;
            EXPECT_LT(error, 0.003) << truth.transpose() << " from " << start.transpose() << ": "
                                    << estimate.translation.transpose();
            EXPECT_EQ(estimate.unobservedAxes.cols(), 0);
            EXPECT_GT(estimate.matches, 500U);
            EXPECT_GT(estimate.observability.minCoeff(), 0.05);
            EXPECT_NEAR(estimate.observability.sum(), 1, 1e-9);  // each pair sees one direction
        }
    }
    EXPECT_EQ(farStarts, 16);
    EXPECT_GE(found, 13);
}

TEST(LineRegistration, RangeNoiseCostsCentimetres) {
    const Eigen::Vector3d truth(1, 0.3, 0);
    const auto found = registerLines(linesAt(test::room(), {0, 0, 0}, 0.02),
                                     linesAt(test::room(), truth, 0.02), {0.8, 0.2, 0}, {});
    EXPECT_TRUE(found.valid);
    EXPECT_LT((found.translation - truth).norm(), 0.03);
}

// As the paper writes it. Pairs of nearly parallel lines count there and hold what they lie along,
// so the start is not far off.
TEST(LineRegistration, CentroidsGetThereWithManySmallSteps) {
    const auto from = linesAt(test::room(), {0, 0, 0});
    const Eigen::Vector3d truth(0.7, -0.3, 0.1);
    const auto to = linesAt(test::room(), truth);
    const Eigen::Vector3d start = truth + Eigen::Vector3d(0.05, -0.05, 0.05);
    const auto few = registerLines(from, to, start, withCentroids(3));
    const auto many = registerLines(from, to, start, withCentroids(1000));
    EXPECT_TRUE(few.valid);
    EXPECT_EQ(few.iterations, 3U);
    EXPECT_TRUE(many.valid);
    EXPECT_GT(many.iterations, 6U);
    EXPECT_LT((many.translation - truth).norm(), 0.02);
    EXPECT_LT((many.translation - truth).norm(), (few.translation - truth).norm());
    EXPECT_TRUE(isCovariance(many.covariance));
}

TEST(LineRegistration, TheSearchNeedsNoPrediction) {
    LineRegistrationOptions options;
    const Eigen::Vector3d truth(1.3, 0.75, 0);
    const auto found =
        searchTranslation(linesAt(test::room(), {0, 0, 0}), linesAt(test::room(), truth),
                          Eigen::Vector3d::Zero(), 2, options);
    EXPECT_TRUE(found.valid);
    EXPECT_LT((found.translation - truth).norm(), 0.01) << found.translation.transpose();
}

TEST(LineRegistration, TheSearchForgivesAPredictionThatIsTwoMetresOff) {
    LineRegistrationOptions options;
    const Eigen::Vector3d truth(0.8, -0.3, 0.02);
    const auto from = linesAt(test::yard(), {0, 0, 0}), to = linesAt(test::yard(), truth);
    for (double azimuth = 0; azimuth < 6; azimuth += 1) {
        const Eigen::Vector3d off(2 * std::cos(azimuth), 2 * std::sin(azimuth), 0.1);
        const auto found = searchTranslation(from, to, truth + off, 3, options);
        EXPECT_TRUE(found.valid);
        EXPECT_LT((found.translation - truth).norm(), 0.03) << off.transpose();
    }
}

TEST(LineRegistration, AlongACorridorThePredictionStays) {
    const auto from = linesAt(test::corridor(), {0, 0, 0});
    const auto to = linesAt(test::corridor(), {1, 0.2, 0.05});
    const Eigen::Vector3d predicted(0.6, 0, 0);
    LineRegistrationOptions options;
    // Lines from a wall to the ground lean over their edge: some 0.0075 is seen where nothing is.
    options.prior_sigma = 0.3;
    const auto found = registerLines(from, to, predicted, options);
    EXPECT_TRUE(found.valid);
    ASSERT_EQ(found.unobservedAxes.cols(), 1);
    const Eigen::Vector3d axis = found.unobservedAxes.col(0);
    EXPECT_NEAR(std::abs(axis.x()), 1, 1e-3);
    EXPECT_LT(found.observability[0], options.min_observability);
    EXPECT_NEAR(axis.dot(found.translation), axis.dot(predicted), 1e-9);
    EXPECT_NEAR(found.translation.y(), 0.2, 0.01);
    EXPECT_NEAR(found.translation.z(), 0.05, 0.01);
    EXPECT_NEAR(axis.dot(found.covariance * axis), 0.09, 1e-9);
    EXPECT_TRUE(isCovariance(found.covariance));
    EXPECT_LT(found.covariance.trace(), 0.1);
    EXPECT_LT((axis.transpose() * found.lever).norm(), 1e-9);  // it follows no rotation there
}

TEST(LineRegistration, WithTooFewLinesThePredictionStays) {
    const auto many = linesAt(test::room(), {0, 0, 0});
    LineCloud few = many;
    few.midpoints.conservativeResize(3, 60);
    few.directions.conservativeResize(3, 60);
    few.lengths.conservativeResize(60);
    LineCloud far = linesAt(test::room(), {0.1, 0, 0});
    far.midpoints.array() += 1000;
    const Eigen::Vector3d predicted(1, 2, 3);
    for (const auto& options : {LineRegistrationOptions{}, withCentroids(100)})
        for (const auto& [from, to] :
             {std::pair(many, few), std::pair(many, far), std::pair(many, LineCloud{}),
              std::pair(LineCloud{}, many), std::pair(LineCloud{}, LineCloud{})}) {
            const auto found = registerLines(from, to, predicted, options);
            EXPECT_FALSE(found.valid);
            EXPECT_EQ(found.translation, predicted);
            EXPECT_EQ(found.unobservedAxes.cols(), 3);
            EXPECT_EQ(found.covariance, Eigen::Matrix3d(0.25 * Eigen::Matrix3d::Identity()));
            const auto searched = searchTranslation(from, to, Eigen::Vector3d::Zero(), 3, options);
            EXPECT_FALSE(searched.valid);
            EXPECT_EQ(searched.translation, Eigen::Vector3d(0, 0, 0));
        }
}

// Where a drive slows down or starts: the rings on the ground move with the sensor.
TEST(LineRegistration, SmallMotionsAreFoundFromRest) {
    const auto from = linesAt(test::room(), {0, 0, 0}, 0.01);
    for (const Eigen::Vector3d& truth : {Eigen::Vector3d(0.02, 0, 0), Eigen::Vector3d(0.05, 0, 0),
                                         Eigen::Vector3d(0, 0, 0.05), Eigen::Vector3d(0.2, 0, 0)}) {
        const auto found = registerLines(from, linesAt(test::room(), truth, 0.01), {0, 0, 0}, {});
        EXPECT_TRUE(found.valid);
        EXPECT_LT((found.translation - truth).norm(), 0.005) << found.translation.transpose();
    }
}

/** Pairs of lines that cross each other in their midpoints, each pair far from the next one; and as
 *  many pairs half a metre apart, which are farther than the mean and so never count: whatever
 *  turns or moves a little, the pairs stay. */
std::pair<LineCloud, LineCloud> crossingLines() {
    test::Noise noise;
    LineCloud from;
    from.midpoints.resize(3, 512);
    from.directions.resize(3, 512);
    from.lengths = Eigen::VectorXf::Ones(512);
    LineCloud to = from;
    for (int i = 0; i < 512; ++i) {
        const Eigen::Vector3d at(4 * (i % 8) - 10, 4 * (i / 8 % 8) - 20, 4 * (i / 64) - 9);
        const Eigen::Vector3d shift(0, 0, i % 2 == 0 ? 0.5 : 0);
        const Eigen::Vector3d u = noise.direction();
        from.midpoints.col(i) = at.cast<float>();
        to.midpoints.col(i) = (at + shift).cast<float>();
        from.directions.col(i) = u.cast<float>();
        to.directions.col(i) = u.cross(noise.direction()).normalized().cast<float>();
    }
    return {from, to};
}

TEST(LineRegistration, TheLeverIsHowTheTranslationFollowsTheRotation) {
    const auto [from, to] = crossingLines();
    LineRegistrationOptions options;
    options.converged = 0;
    options.max_iterations = 10;
    const auto found = registerLines(from, to, {0, 0, 0}, options);
    ASSERT_TRUE(found.valid);
    EXPECT_EQ(found.matches, 256U);
    EXPECT_LT(found.translation.norm(), 1e-6);
    const double w = 5e-4;
    Eigen::Matrix3d numeric;
    for (int k = 0; k < 3; ++k) {
        const auto at = [&](double angle) {
            const Eigen::Matrix3d turned =
                test::rotationAbout(Eigen::Vector3d::Unit(k), angle * 180 / M_PI);
            return registerLines(from, paper::rotated(to, turned), {0, 0, 0}, options).translation;
        };
        numeric.col(k) = (at(w) - at(-w)) / (2 * w);
    }
    EXPECT_GT(numeric.norm(), 3);  // the lines' centre is 5 m ahead
    // Floats have 2e-6 m at 20 m, 4e-3 of a lever, and pairs average it.
    EXPECT_LT((found.lever - numeric).norm(), 0.01 * numeric.norm()) << found.lever << "\n\n"
                                                                     << numeric;
}

TEST(LineRegistration, MoreNoiseGivesALargerCovariance) {
    double before = 0;
    for (const double noise_m : {0.005, 0.02, 0.05}) {
        const auto found =
            registerLines(linesAt(test::room(), {0, 0, 0}, noise_m),
                          linesAt(test::room(), {0.5, 0, 0}, noise_m), {0.5, 0, 0}, {});
        EXPECT_TRUE(isCovariance(found.covariance));
        EXPECT_GT(found.covariance.trace(), before);
        before = found.covariance.trace();
    }
}

TEST(LineRegistration, FewerIterationsAreHeeded) {
    LineRegistrationOptions options;
    options.max_iterations = 2;
    const auto found = registerLines(linesAt(test::room(), {0, 0, 0}),
                                     linesAt(test::room(), {0.5, 0, 0}), {0.2, 0, 0}, options);
    EXPECT_TRUE(found.valid);
    EXPECT_EQ(found.iterations, 2U);
}
}  // namespace
