#include "tunnel_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "ground.h"

namespace delio::synth {
namespace {
constexpr double kWall_m = 5.3, kSpring_m = 2.6, kCrown_m = 6.2, kConcrete = 0.4;

/** One half of the tube, from the foot of the wall to the crown: away from the centre line, and
 *  above it. */
std::vector<Eigen::Vector2d> halfSection() {
    constexpr int kParts = 12;
    std::vector<Eigen::Vector2d> section = {{kWall_m, -0.3}};
    for (int i = 0; i <= kParts; ++i) {
        const double angle = 3.14159265358979323846 / 2 * i / kParts;
        section.emplace_back(kWall_m * std::cos(angle),
                             kSpring_m + (kCrown_m - kSpring_m) * std::sin(angle));
    }
    return section;
}
}  // namespace

Mesh TunnelScene::tile(int index) const {
    const double begin_s = index * kTileLength_m, end_s = begin_s + kTileLength_m;
    if (end_s <= begin_m_ || begin_s >= end_m_) return RuralScene::tile(index);
    Mesh mesh;
    addGround(mesh, road(), begin_s, end_s);
    addLining(mesh, begin_s, end_s);
    for (const double portal : {begin_m_, end_m_})
        if (portal >= begin_s && portal <= end_s) addPortal(mesh, portal);
    return mesh;
}

void TunnelScene::addLining(Mesh& mesh, double begin_s, double end_s) const {
    const auto section = halfSection();
    const Frame a = frameAt(begin_s, 0), b = frameAt(end_s, 0);
    for (const double side : {-1.0, 1.0})
        for (std::size_t i = 0; i + 1 < section.size(); ++i) {
            const Eigen::Vector2d &p = section[i], &q = section[i + 1];
            mesh.addQuad(a.world(0, side * p.x(), p.y()), b.world(0, side * p.x(), p.y()),
                         b.world(0, side * q.x(), q.y()), a.world(0, side * q.x(), q.y()),
                         kConcrete);
        }
}

void TunnelScene::addPortal(Mesh& mesh, double s) const {
    constexpr double kHalf = 16, kTop = 9;
    const Frame frame = frameAt(s, 0);
    const auto section = halfSection();
    for (const double side : {-1.0, 1.0}) {
        mesh.addQuad(frame.world(0, side * kWall_m, -2), frame.world(0, side * kHalf, -2),
                     frame.world(0, side * kHalf, kTop), frame.world(0, side * kWall_m, kTop),
                     kConcrete);
        for (std::size_t i = 0; i + 1 < section.size(); ++i)
            mesh.addQuad(frame.world(0, side * section[i].x(), section[i].y()),
                         frame.world(0, side * section[i + 1].x(), section[i + 1].y()),
                         frame.world(0, side * section[i + 1].x(), kTop),
                         frame.world(0, side * section[i].x(), kTop), kConcrete);
    }
}
}  // namespace delio::synth
