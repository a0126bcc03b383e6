#include "ground.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

namespace delio::synth {
namespace {
constexpr double kRoadStep_m = 0.5;
constexpr double kSkirt_m = 0.5;  // of the land, under the edge of the road

struct Sheet {
    std::vector<double> stations, sides;
    std::function<double(double s, double side)> reflectivity;
    double sunkWithin_m = 0;  //!< what is nearer to a road lies under it
};

/** Row after row of vertices across the road; remembers which are nearest to this stretch. */
class SheetBuilder {
 public:
    SheetBuilder(Mesh& mesh, const Road& road, const Sheet& sheet)
        : mesh_(mesh), road_(road), sheet_(sheet) {}

    void build() {
        bool hadRow = false;
        for (const double s : sheet_.stations) {
            const bool owned = road_.owns(s);
            if (owned || hadRow) addRow(s);
            if (hadRow) connect(s);
            if (owned || hadRow) before_ = now_;
            hadRow = owned;
        }
    }

 private:
    struct Vertex {
        std::uint32_t number;
        bool mine;
    };

    void addRow(double s) {
        now_.clear();
        for (const double side : sheet_.sides) {
            const Eigen::Vector2d place = road_.point(s, side);
            const auto nearest = road_.nearest(place);
            const bool sunk = nearest.distance < sheet_.sunkWithin_m;
            const double z = road_.height(place, nearest.distance) - (sunk ? 0.8 : 0);
            const double own = std::min(std::abs(side), Road::kReach_m);
            now_.push_back({mesh_.addVertex({place.x(), place.y(), z}),
                            nearest.beyondEnd || own - nearest.distance < 0.3});
        }
    }

    void connect(double s) {
        for (std::size_t j = 0; j + 1 < now_.size(); ++j) {
            const Vertex &a = before_[j], &b = before_[j + 1], &c = now_[j + 1], &d = now_[j];
            if (!a.mine && !b.mine && !c.mine && !d.mine) continue;
            const double colour =
                sheet_.reflectivity(s, (sheet_.sides[j] + sheet_.sides[j + 1]) / 2);
            mesh_.addTriangle(a.number, b.number, c.number, colour);
            mesh_.addTriangle(a.number, c.number, d.number, colour);
        }
    }

    Mesh& mesh_;
    const Road& road_;
    const Sheet& sheet_;
    std::vector<Vertex> before_, now_;
};

std::vector<double> steps(double begin, double end, double step) {
    std::vector<double> places;
    const int count = static_cast<int>(std::lround((end - begin) / step));
    for (int i = 0; i <= count; ++i) places.push_back(begin + (end - begin) * i / count);
    return places;
}

std::vector<double> bothSides(const std::vector<double>& right) {
    std::vector<double> across;
    for (auto side = right.rbegin(); side != right.rend(); ++side) across.push_back(-*side);
    for (const double side : right)
        if (side > 0) across.push_back(side);
    return across;
}

/** Close together beside the road, wider apart away from it. */
std::vector<double> landColumns(const RoadProfile& profile) {
    std::vector<double> columns = {profile.half_m - kSkirt_m};
    for (double away = profile.half_m; away < profile.landReach_m;
         away += std::max(profile.landStep_m, 0.07 * (away - profile.half_m)))
        columns.push_back(away);
    columns.push_back(profile.landReach_m);
    return columns;
}
}  // namespace

void addGround(Mesh& mesh, const Road& road, double begin_s, double end_s) {
    const RoadProfile& profile = road.profile();
    Sheet paved;
    paved.stations = steps(begin_s, end_s, kRoadStep_m);
    paved.sides = bothSides(profile.columns());
    paved.reflectivity = [&](double s, double side) {
        return profile.reflectivity(s, std::abs(side));
    };
    SheetBuilder(mesh, road, paved).build();
    for (const double sign : {-1.0, 1.0}) {
        Sheet land;
        land.stations = steps(begin_s, end_s, std::max(2 * kRoadStep_m, profile.landStep_m));
        land.sides = landColumns(profile);
        for (auto& side : land.sides) side *= sign;
        land.reflectivity = [&](double, double) {
            return profile.bands.back().reflectivity - 0.06;
        };
        land.sunkWithin_m = profile.half_m - 0.1;
        SheetBuilder(mesh, road, land).build();
    }
}
}  // namespace delio::synth
