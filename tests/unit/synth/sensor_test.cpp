#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "echo.h"
#include "faults.h"
#include "own_vehicle.h"
#include "sensor_model.h"

namespace {
using namespace delio::synth;
constexpr double kDegree = 3.14159265358979323846 / 180;

struct Expected {
    const char* option;
    const char* name;
    std::size_t lasers;
    double top_deg, bottom_deg;
    int columns;
    double reach_m;
};

TEST(SynthSensor, TablesAreThoseOfTheManuals) {
    const Expected all[] = {{"hdl64e", "HDL-64E", 64, 2, -24.33, 2083, 120},
                            {"hdl32e", "HDL-32E", 32, 10.67, -30.67, 2170, 100},
                            {"vlp16", "VLP-16", 16, 15, -15, 1808, 100},
                            {"os1-64", "OS1-64", 64, 16.6, -16.6, 1024, 120}};
    const auto models = sensorModels();
    ASSERT_EQ(models.size(), std::size(all));
    for (std::size_t i = 0; i < models.size(); ++i) {
        EXPECT_EQ(models[i].option, all[i].option);
        EXPECT_EQ(models[i].name, all[i].name);
        const auto& elevations = models[i].elevations_rad;
        ASSERT_EQ(elevations.size(), all[i].lasers);
        EXPECT_NEAR(elevations.front() / kDegree, all[i].top_deg, 0.005);
        EXPECT_NEAR(elevations.back() / kDegree, all[i].bottom_deg, 0.005);
        EXPECT_TRUE(std::is_sorted(elevations.rbegin(), elevations.rend()));
        EXPECT_EQ(models[i].columns, all[i].columns);
        EXPECT_EQ(models[i].maxRange_m, all[i].reach_m);
    }
}

TEST(SynthSensor, AllButTheHdl64eHaveEvenSteps) {
    for (const auto& model : sensorModels()) {
        if (model.option == "hdl64e") continue;
        const auto& e = model.elevations_rad;
        for (std::size_t i = 2; i < e.size(); ++i)
            EXPECT_NEAR(e[i - 1] - e[i], e[0] - e[1], 1e-12) << model.option;
    }
}

TEST(SynthEcho, IsWeakerFromAfar) {
    Random random{1};
    const auto mean = [&](double range) {
        double sum = 0;
        for (int i = 0; i < 200; ++i) sum += intensity({range, 0.7, 0.4, false}, 1, random) / 200;
        return sum;
    };
    EXPECT_NEAR(mean(5), mean(15), 0.02);
    EXPECT_LT(mean(35), 0.8 * mean(10));
    EXPECT_LT(mean(75), 0.05);
}

TEST(SynthEcho, OnlySurfacesLessThanAPulseApartMix) {
    Random random{1};
    const Hit front{10, 1, 0.5, false}, behind{11, 1, 0.5, false}, far{14, 1, 0.5, false}, none{};
    int mixed = 0;
    for (int i = 0; i < 500; ++i) {
        const double share = mixedShare(front, behind, random);
        EXPECT_GE(share, 0);
        EXPECT_LT(share, 1);
        mixed += share > 0 ? 1 : 0;
        EXPECT_EQ(mixedShare(front, far, random), 0);
        EXPECT_EQ(mixedShare(front, none, random), 0);
        EXPECT_EQ(mixedShare(front, front, random), 0);
    }
    EXPECT_GT(mixed, 50);
    EXPECT_LT(mixed, 200);
}

TEST(SynthOwnVehicle, HidesTheGroundBehindMoreThanBeside) {
    for (const double azimuth : {-180.0, -170.0, 175.0, 180.0, 185.0})
        EXPECT_TRUE(behindOwnVehicle(azimuth * kDegree, -19 * kDegree)) << azimuth;
    EXPECT_FALSE(behindOwnVehicle(90 * kDegree, -24.3 * kDegree));
    EXPECT_FALSE(behindOwnVehicle(0, -18 * kDegree));
    EXPECT_TRUE(behindOwnVehicle(0, -21 * kDegree));
    EXPECT_TRUE(behindOwnVehicle(360 * kDegree, -21 * kDegree));
    EXPECT_FALSE(behindOwnVehicle(180 * kDegree, -10 * kDegree));
}

/** By small steps along the ray; 0: it misses the box. */
double rangeBySteps(const OwnBox& own, const Eigen::Vector3d& direction) {
    for (double range = 0; range < 12; range += 0.002)
        if (own.box.contains(own.sensor * (range * direction))) return range;
    return 0;
}

TEST(SynthOwnVehicle, ABoxIsHitWhereRaysEnterIt) {
    OwnBox own{{Eigen::Vector3d(-7, -1.2, -1.5), Eigen::Vector3d(-4, 1.2, 0.8)}};
    Random random{7};
    for (const bool isSecond : {false, true}) {
        if (isSecond) own.sensor.translation() << -0.5, 2, 0.3;
        if (isSecond)
            own.sensor.rotate(Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()));
        std::vector<Eigen::Vector3d> rays;
        for (int i = 0; i < 2000; ++i)
            rays.push_back(
                Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized());
        std::vector<Hit> hits(rays.size());
        hits[0].range = 0.5;
        castOwnBox(own, rays, hits);
        int inside = 0;
        for (std::size_t i = 1; i < rays.size(); ++i) {
            EXPECT_NEAR(hits[i].range, rangeBySteps(own, rays[i]), 0.002) << i;
            inside += hits[i].range > 0;
        }
        EXPECT_GT(inside, 10);
        EXPECT_EQ(hits[0].range, 0.5);
    }
    std::vector<Hit> ahead(1);
    castOwnBox(OwnBox{own.box}, {-Eigen::Vector3d::UnitX()}, ahead);
    EXPECT_EQ(ahead[0].range, 4);
    EXPECT_EQ(ahead[0].cosIncidence, 1);
}

TEST(SynthFaults, ComeAsOftenAsAskedAndNeverFirst) {
    const FaultRates rates{0.2, 0.1, 0.05};
    int dropped = 0, repeated = 0, empty = 0;
    constexpr int kScans = 20000;
    for (std::size_t scan = 0; scan < kScans; ++scan) {
        const Fault fault = faultOf(rates, scan, 1);
        dropped += fault == Fault::kDropped ? 1 : 0;
        repeated += fault == Fault::kRepeated ? 1 : 0;
        empty += fault == Fault::kEmpty ? 1 : 0;
        EXPECT_EQ(faultOf({}, scan, 1), Fault::kNone);
        if (fault == Fault::kDropped) {
            EXPECT_EQ(faultOf({0.2, 0, 0.9}, scan, 1), fault);
        }
    }
    EXPECT_NEAR(dropped / double{kScans}, 0.2, 0.01);
    EXPECT_NEAR(repeated / double{kScans}, 0.1 * 0.8, 0.01);
    EXPECT_NEAR(empty / double{kScans}, 0.05 * 0.9 * 0.8, 0.01);
    for (std::uint64_t seed = 0; seed < 50; ++seed)
        EXPECT_EQ(faultOf({0.99, 0.99, 0.99}, 0, seed), Fault::kNone);
    const FaultRates gap{0, 0, 0, 3, 2};
    for (const auto& [scan, fault] : {std::pair<std::size_t, Fault>{2, Fault::kNone},
                                      {3, Fault::kDropped},
                                      {4, Fault::kDropped},
                                      {5, Fault::kNone}})
        EXPECT_EQ(faultOf(gap, scan, 1), fault) << scan;
}
}  // namespace
