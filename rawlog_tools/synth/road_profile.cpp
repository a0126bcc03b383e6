#include "road_profile.h"

#include <algorithm>
#include <cmath>

namespace delio::synth {
namespace {
constexpr double kAsphalt = 0.24, kPaint = 0.8;
}

double RoadProfile::height(double away_m) const {
    for (std::size_t i = 1; i < section.size(); ++i) {
        const Corner &low = section[i - 1], &high = section[i];
        if (away_m > high.away_m) continue;
        const double u = (away_m - low.away_m) / (high.away_m - low.away_m);
        return low.height_m + u * (high.height_m - low.height_m);
    }
    return section.back().height_m;
}

double RoadProfile::reflectivity(double s, double away_m) const {
    for (const auto& mark : marks)
        if (std::abs(away_m - mark.away_m) < mark.width_m / 2 &&
            std::fmod(s + 1e5, mark.period_m) < mark.dash_m)
            return kPaint;
    for (const auto& band : bands)
        if (away_m < band.until_m) return band.reflectivity;
    return bands.back().reflectivity;
}

std::vector<double> RoadProfile::columns() const {
    constexpr double kWidest_m = 1.2;
    std::vector<double> edges = {0, half_m};
    for (const auto& corner : section) edges.push_back(corner.away_m);
    for (const auto& mark : marks)
        for (const double side : {-0.5, 0.5}) edges.push_back(mark.away_m + side * mark.width_m);
    std::sort(edges.begin(), edges.end());
    std::vector<double> all;
    for (const double edge : edges) {
        if (edge < 0 || edge > half_m || (!all.empty() && edge - all.back() < 1e-6)) continue;
        const double from = all.empty() ? edge : all.back();
        const int parts = std::max(1, static_cast<int>(std::ceil((edge - from) / kWidest_m)));
        for (int i = 1; i <= parts; ++i) all.push_back(from + (edge - from) * i / parts);
    }
    return all;
}

RoadProfile urbanProfile() {
    RoadProfile p{};
    p.lanes = {{-1.6, 1, 10}, {1.6, -1, 10}};
    // Crossfall of 2 %, a kerb of 13 cm, a sidewalk that falls towards it.
    p.section = {{0, 0}, {5.5, -0.11}, {5.53, 0.02}, {8.7, 0.068}};
    p.bands = {{5.5, kAsphalt}, {1e3, 0.36}};
    p.marks = {{0, 0.14, 3, 6}, {3.36, 0.12, 1, 1}};
    p.half_m = 9.2;
    p.landReach_m = 60;
    p.landStep_m = 4;
    p.waves = {{0.9, 380},  {0.6, 240}, {0.012, 27},  {0.010, 19},
               {0.010, 13}, {0.003, 7}, {0.003, 5.5}, {0.002, 4}};
    p.style = {9, 12, 0.48, 0.35, 220};
    return p;
}

RoadProfile blockProfile() {
    RoadProfile p = urbanProfile();
    p.style = {9, 12, 0.59, 0.35, 320};
    return p;
}

RoadProfile ruralProfile() {
    RoadProfile p{};
    p.lanes = {{-1.5, 1, 19}, {1.5, -1, 19}};
    p.section = {{0, 0}, {3.1, -0.08}, {4.4, -0.16}, {5.6, -0.42}, {6.8, -0.1}};  // with a ditch
    p.bands = {{3.1, kAsphalt}, {1e3, 0.42}};
    p.marks = {{0, 0.12, 4, 12}, {2.9, 0.12, 1, 1}};
    p.half_m = 7.2;
    p.landReach_m = 64;
    p.landStep_m = 0.5;
    p.waves = {{4.2, 430},  {1.3, 190}, {0.015, 29},   {0.014, 21},
               {0.008, 12}, {0.003, 8}, {0.0025, 5.6}, {0.0012, 4}};
    p.bank_m = 1.7;
    p.bankFrom_m = 5.5;
    p.bankTo_m = 14;
    p.roughness_m = 0.05;
    p.style = {16, 21, 0.4, 0.5, 0};
    return p;
}

RoadProfile highwayProfile() {
    RoadProfile p{};
    p.lanes = {{-7.9, 1, 31}, {-4.3, 1, 35}, {-11.5, 1, 24},
               {7.9, -1, 31}, {4.3, -1, 35}, {11.5, -1, 24}};
    p.section = {{0, 0.02}, {1.9, 0}, {16, -0.35}, {17.2, -0.45}};
    p.bands = {{1.9, 0.4}, {16, kAsphalt}, {1e3, 0.42}};
    p.marks = {{2.4, 0.2, 1, 1}, {6.1, 0.15, 6, 18}, {9.7, 0.15, 6, 18}, {13.4, 0.3, 1, 1}};
    p.half_m = 17.6;
    p.landReach_m = 100;
    p.landStep_m = 0.8;
    p.waves = {{7, 1100},   {2.2, 520}, {0.012, 43}, {0.010, 31},
               {0.006, 18}, {0.003, 9}, {0.002, 7},  {0.001, 5}};
    p.bank_m = 3.2;
    p.bankFrom_m = 18.5;
    p.bankTo_m = 42;
    p.roughness_m = 0.05;
    p.style = {27, 33, 0.3, 1, 0};
    return p;
}

RoadProfile tunnelProfile() {
    RoadProfile p{};
    p.lanes = {{-1.9, 1, 19}, {1.9, -1, 19}};
    p.section = {{0, 0}, {4, -0.08}, {4.02, 0.08}, {5.4, 0.08}};
    p.bands = {{4, kAsphalt}, {1e3, 0.36}};
    p.marks = {{3.7, 0.15, 1, 1}};  // no dashes: they would show the place along the tunnel
    p.half_m = 5.6;
    p.landReach_m = 60;
    p.landStep_m = 1;
    p.grade = 0.015;
    p.bank_m = 2;
    p.bankFrom_m = 7;
    p.bankTo_m = 20;
    p.roughness_m = 0.05;
    p.style = {17, 21, 0.4, 1, 0};
    return p;
}

RoadProfile forestProfile() {
    RoadProfile p{};
    p.lanes = {{0, 1, 4}};
    p.section = {{0, 0}, {0.5, 0}, {0.75, -0.06}, {1, 0}, {1.4, 0.03}, {1.8, 0.02}};
    p.bands = {{1.1, 0.3}, {1e3, 0.4}};
    p.half_m = 2.2;
    p.landReach_m = 56;
    p.landStep_m = 0.5;
    p.waves = {{1.8, 150},  {0.5, 47},    {0.07, 13},  {0.055, 8.5},
               {0.04, 6.3}, {0.025, 4.8}, {0.015, 3.9}};
    p.bank_m = 0.7;
    p.bankFrom_m = 2.5;
    p.bankTo_m = 9;
    p.roughness_m = 0.07;
    p.style = {2.5, 5, 0.5, 0.5, 0};
    p.carrier = {{0.95, 0.75}, 1.6, true};
    p.footways = {-2.1, 2.1};
    return p;
}

RoadProfile indoorProfile() {
    RoadProfile p{};
    p.lanes = {{0, 1, 1}};
    p.section = {{0, 0}};
    p.bands = {{1e3, 0.4}};
    p.half_m = 1;
    p.bankFrom_m = 1;
    p.bankTo_m = 2;
    p.style = {0.9, 1.15, 0.9, 0.5, 0};
    p.carrier = onFoot();
    p.footways = {0};
    return p;
}
}  // namespace delio::synth
