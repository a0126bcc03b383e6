#include "mesh.h"

#include <cmath>

namespace delio::synth {
using Eigen::Vector3d;

Frame Frame::turned(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return {origin, c * x + s * y, c * y - s * x};
}

std::uint32_t Mesh::addVertex(const Vector3d& place) {
    vertices_.push_back(place.cast<float>());
    return static_cast<std::uint32_t>(vertices_.size() - 1);
}

void Mesh::addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, double reflectivity) {
    triangles_.push_back({{a, b, c}, static_cast<float>(reflectivity)});
}

void Mesh::addQuad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d,
                   double reflectivity) {
    const auto first = addVertex(a);
    addVertex(b);
    addVertex(c);
    addVertex(d);
    addTriangle(first, first + 1, first + 2, reflectivity);
    addTriangle(first, first + 2, first + 3, reflectivity);
}

void Mesh::addFrustum(const Frame& frame, const Rectangle& low, double z0, const Rectangle& high,
                      double z1, double reflectivity) {
    const auto corner = [&](const Rectangle& r, int i, double z) {
        const double u = i == 0 || i == 3 ? -0.5 : 0.5, v = i < 2 ? -0.5 : 0.5;
        return frame.world(r.x + u * r.length, r.y + v * r.width, z);
    };
    std::array<Vector3d, 4> bottom, top;
    for (int i = 0; i < 4; ++i) {
        bottom[static_cast<std::size_t>(i)] = corner(low, i, z0);
        top[static_cast<std::size_t>(i)] = corner(high, i, z1);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) % 4;
        addQuad(bottom[i], bottom[j], top[j], top[i], reflectivity);
    }
    addQuad(bottom[0], bottom[1], bottom[2], bottom[3], reflectivity);
    addQuad(top[0], top[1], top[2], top[3], reflectivity);
}

void Mesh::addBox(const Frame& frame, const Rectangle& base, double z0, double z1,
                  double reflectivity) {
    addFrustum(frame, base, z0, base, z1, reflectivity);
}

void Mesh::addPost(const Frame& frame, double radiusLow, double radiusHigh, double z0, double z1,
                   double reflectivity) {
    constexpr int kSides = 8;
    const auto ring = [&](int i, double radius, double z) {
        const double angle = 2 * 3.14159265358979323846 / kSides * i;
        return frame.world(radius * std::cos(angle), radius * std::sin(angle), z);
    };
    for (int i = 0; i < kSides; ++i)
        addQuad(ring(i, radiusLow, z0), ring(i + 1, radiusLow, z0), ring(i + 1, radiusHigh, z1),
                ring(i, radiusHigh, z1), reflectivity);
}

void Mesh::addLeaf(const Vector3d& centre, double size, double reflectivity, Random& random) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    for (int i = 0; i < 3; ++i)
        addVertex(centre + size * Vector3d{random.uniform(-1, 1), random.uniform(-1, 1),
                                           random.uniform(-1, 1)});
    addTriangle(first, first + 1, first + 2, reflectivity);
}
}  // namespace delio::synth
