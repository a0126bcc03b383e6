#include <algorithm>

#include "odometry_drive.h"
#include "states.h"

// An odometry that is stored after any scan and restored goes on as if nothing had been.
namespace {
using namespace delio;
using namespace delio::odometry_test;
using test::bytesOf;
using test::stateOf;

/** Nothing that was ever there, nor will be again. */
Scan rubbish(std::uint32_t seed) {
    test::Noise noise(seed);
    Eigen::Matrix3Xf points(3, 1500);
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points.col(i) = ((4 + 2 * noise.uniform()) * noise.direction()).cast<float>();
    return test::scanOf(points);
}

/** Through the yard, behind a car that is faster, points with times; a scan half of which is
 * rubbish, an empty one, a pause, and rubbish until it is taken for a map. */
std::vector<Scan> eventfulScans() {
    const auto poses = drive(17);
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto seed = static_cast<std::uint32_t>(i);
        auto scene = test::yard();
        const Eigen::Vector3d car =
            poses[i] * Eigen::Vector3d(6 + 0.6 * static_cast<double>(i), 0, 0);
        scene.push_back({car - Eigen::Vector3d(1.5, 0.8, 1.5), car + Eigen::Vector3d(1.5, 0.8, 0)});
        if (i == 7)
            scans.push_back(test::scanOf(Eigen::Matrix3Xf(3, 0)));
        else
            scans.push_back(i < 10 || i > 12 ? scanAt(poses[i], seed, scene) : rubbish(seed));
        if (i == 8) scans.back().points->insertAnotherMap(rubbish(seed).points.get(), {});
        auto& scan = scans.back();
        scan.index = i;
        scan.stamp_s = 0.1 * static_cast<double>(i) + (i > 8 ? 30 : 0);
        for (std::size_t k = 0; k < scan.points->size(); ++k)
            scan.times_s.push_back(1e-3F * static_cast<float>(k % 5));
    }
    return scans;
}

/** `after`: numbers of scans. Gives the steps. */
std::vector<Step> goneOn(const std::vector<Scan>& scans, const OdometryOptions& options,
                         const std::vector<std::size_t>& after) {
    const auto never = stepsOf(scans, options);  // stored
    const auto whole = makeOdometry(options);
    std::vector<std::string> steps, states;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        states.push_back(stateOf(*whole));
        steps.push_back(bytesOf(whole->process(scans[i])));
        EXPECT_TRUE(steps[i] == bytesOf(never[i])) << i;
    }
    for (const std::size_t count : after) {
        SCOPED_TRACE(count);
        const auto again = makeOdometry(options);
        test::restore(*again, states[count]);
        EXPECT_TRUE(stateOf(*again) == states[count]);
        for (std::size_t i = count; i < scans.size(); ++i)
            EXPECT_TRUE(bytesOf(again->process(scans[i])) == steps[i]) << i;
        EXPECT_TRUE(stateOf(*again) == stateOf(*whole));
    }
    return never;
}

std::vector<std::size_t> all(std::size_t count) {
    std::vector<std::size_t> numbers;
    while (numbers.size() < count) numbers.push_back(numbers.size());
    return numbers;
}

TEST(OdometryState, PlanesGoOnFromAnyScan) {
    goneOn(scansOf(drive(14)), quick("accurate"), all(14));
}

TEST(OdometryState, PlanesGoOnWhateverHappens) {
    const auto scans = eventfulScans();
    const auto steps = goneOn(scans, quick("accurate"), {1, 5, 6, 8, 12, 13});
    const auto any = [&](const auto& is) {
        return std::any_of(steps.begin() + 1, steps.end(), is);
    };
    EXPECT_TRUE(any([](const Step& step) { return step.interrupted; }));
    EXPECT_TRUE(any([](const Step& step) { return step.searched; }));
    EXPECT_TRUE(any([](const Step& step) { return step.deskewed; }));
    EXPECT_TRUE(any([](const Step& step) { return step.reason == "no points"; }));
    EXPECT_TRUE(any([](const Step& step) { return step.reason == "not found in the map"; }));
    EXPECT_TRUE(any([](const Step& step) { return valueOf(step.details, "dynamic") > 0; }));
    // A new map was begun: at another scale.
    EXPECT_TRUE(any([&](const Step& step) {
        return valueOf(step.details, "scale") != valueOf(steps[0].details, "scale");
    }));
}

TEST(OdometryState, ThePapersGoesOnFromAnyScan) {
    goneOn(scansOf(drive(12)), quick("paper", 1), {0, 1, 2, 5, 11});
}

TEST(OdometryState, ThePapersGoesOnWhateverHappens) {
    goneOn(eventfulScans(), quick("paper"), {1, 8, 11});
}

TEST(OdometryState, ThePaperToTheLetterGoesOn) {
    goneOn(scansOf(drive(12)), quick("paper-literal"), {1, 6});
}

TEST(OdometryState, FeaturesRegisterAsBefore) {
    const auto steps = stepsOf(scansOf(drive(3)), quick("paper"));
    std::vector<std::shared_ptr<const ScanFeatures>> again;
    for (const auto& step : steps) {
        std::istringstream in(stateOf(*step.features));
        again.push_back(readFeatures(in));
        EXPECT_TRUE(stateOf(*again.back()) == stateOf(*step.features));
    }
    const Eigen::Isometry3d guess = steps[1].increment.pose * steps[2].increment.pose;
    const auto one = steps[2].features->linkTo(*steps[0].features, guess),
               other = again[2]->linkTo(*again[0], guess);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(one->increment.pose.matrix(), other->increment.pose.matrix());
    EXPECT_EQ(one->increment.covariance, other->increment.covariance);
    EXPECT_EQ(one->overlap, other->overlap);
}

TEST(OdometryState, IsRefusedUnlessItIsWhole) {
    const auto scans = scansOf(drive(2));
    for (const char* profile : {"accurate", "paper"}) {
        SCOPED_TRACE(profile);
        const auto options = quick(profile);
        const auto odometry = makeOdometry(options);
        for (const auto& scan : scans) odometry->process(scan);
        test::expectOnlyWholeStates([&] { return makeOdometry(options); }, stateOf(*odometry));
    }
}

TEST(OdometryState, IsRefusedByAnotherOdometry) {
    const auto planes = quick("accurate"), paper = quick("paper");
    auto others = planes;
    others.planes.map.voxel_size += 1e-9;
    const auto state = stateOf(*makeOdometry(planes));
    EXPECT_NE(test::refusalOf(*makeOdometry(others), state).find("other options"),
              std::string::npos);
    EXPECT_NE(test::refusalOf(*makeOdometry(paper), state).find("other parts"), std::string::npos);
    EXPECT_EQ(test::refusalOf(*makeOdometry(planes), state), "");
}
}  // namespace
