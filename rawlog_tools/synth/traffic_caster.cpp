#include "traffic_caster.h"

#include <cmath>

namespace delio::synth {
namespace {
constexpr double kPi = 3.14159265358979323846;
constexpr double kPlace_m = 16;  // a ray ends before it reaches the next place

Eigen::Vector3d placeOf(std::size_t member) {
    return {0, kPlace_m * static_cast<double>(member), 0};
}

Mesh moved(const Mesh& mesh, const Eigen::Vector3d& by) {
    Mesh result;
    for (const auto& vertex : mesh.vertices()) result.addVertex(vertex.cast<double>() + by);
    for (const auto& t : mesh.triangles())
        result.addTriangle(t.corner[0], t.corner[1], t.corner[2],
                           static_cast<double>(t.reflectivity));
    return result;
}

double radiusOf(const RoadUser& looks) { return looks.box.sizes().norm() / 2; }
}  // namespace

TrafficCaster::TrafficCaster(const Traffic& traffic) : traffic_(traffic) {
    for (std::size_t i = 0; i < traffic.size(); ++i)
        garage_.add(static_cast<int>(i), moved(traffic.looks(i).mesh, placeOf(i)));
    garage_.commit();
}

std::vector<TrafficCaster::View> TrafficCaster::viewsOf(const Sweep& sweep, double maxRange) const {
    std::vector<View> views;
    for (std::size_t i = 0; i < traffic_.size(); ++i) {
        auto view = viewOf(i, sweep, maxRange);
        if (!view.columns.empty()) views.push_back(std::move(view));
    }
    return views;
}

TrafficCaster::View TrafficCaster::viewOf(std::size_t member, const Sweep& sweep,
                                          double maxRange) const {
    const RoadUser& looks = traffic_.looks(member);
    const double radius = radiusOf(looks);
    const auto poseAt = [&](double time_s) {
        return traffic_.pose(member, sweep.stamp_s + time_s);
    };
    // Where it is roughly, for all columns: its path over the sweep is nearly straight.
    const double half_s = kScanPeriod_s / 2;
    const Eigen::Vector3d begin = poseAt(-half_s) * looks.box.center();
    const Eigen::Vector3d end = poseAt(half_s) * looks.box.center();
    View view{member, {}, {}};
    for (std::uint32_t c = 0; c < sweep.azimuth_rad.size(); ++c) {
        const Eigen::Vector3d world =
            begin + (sweep.time_s[c] + half_s) / kScanPeriod_s * (end - begin);
        const auto& lidar = sweep.lidarToWorld[c];
        const Eigen::Vector3d seen = lidar.linear().transpose() * (world - lidar.translation());
        const double level = seen.head<2>().norm();
        if (level - radius > maxRange) continue;
        const double off =
            std::remainder(std::atan2(seen.y(), seen.x()) - sweep.azimuth_rad[c], 2 * kPi);
        const double widest = radius + 0.3;  // lasers are a little off their column
        if (level > widest && std::abs(off) > std::asin(widest / level)) continue;
        view.columns.push_back(c);
        view.lidarToMember.push_back(poseAt(sweep.time_s[c]).inverse() * lidar);
    }
    return view;
}

void TrafficCaster::cast(const View& view, const std::vector<Eigen::Vector3d>& local,
                         std::vector<Hit>& hits) const {
    const RoadUser& looks = traffic_.looks(view.member);
    const double radius = radiusOf(looks);
    const Eigen::Vector3d centre = looks.box.center();
    std::vector<Ray> rays;
    std::vector<std::uint32_t> columns;
    std::vector<double> skipped;  // rays begin where they enter the sphere around the mesh
    for (std::size_t i = 0; i < view.columns.size(); ++i) {
        const auto& pose = view.lidarToMember[i];
        const Eigen::Vector3d origin = pose.translation();
        const Eigen::Vector3d direction = pose.linear() * local[view.columns[i]];
        const double nearest = (centre - origin).dot(direction);
        const double off = (origin + nearest * direction - centre).squaredNorm();
        if (nearest < 0 || off > radius * radius) continue;
        const double skip = std::max(0.0, nearest - radius);
        rays.push_back({origin + skip * direction + placeOf(view.member), direction});
        columns.push_back(view.columns[i]);
        skipped.push_back(skip);
    }
    std::vector<Hit> found;
    garage_.cast(rays, 2 * radius, found);
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i].range <= 0) continue;
        found[i].range += skipped[i];
        found[i].moving = true;
        Hit& hit = hits[columns[i]];
        if (hit.range <= 0 || found[i].range < hit.range) hit = found[i];
    }
}
}  // namespace delio::synth
