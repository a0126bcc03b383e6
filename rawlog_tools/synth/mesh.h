#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "random.h"

namespace delio::synth {
/** Where an object stands: two level axes (not needed to be right-handed: sides of the street are
 *  mirror images) and z up. */
struct Frame {
    Eigen::Vector3d origin;
    Eigen::Vector2d x, y;
    Eigen::Vector3d world(double u, double v, double w) const {
        const Eigen::Vector2d level = u * x + v * y;
        return origin + Eigen::Vector3d(level.x(), level.y(), w);
    }
    /** The same axes, another origin. */
    Frame at(double u, double v, double w) const { return {world(u, v, w), x, y}; }
    /** Turned about the origin's vertical. */
    Frame turned(double angle) const;
};

/** Centre x, y and size along x, y of a level rectangle. */
struct Rectangle {
    double x, y, length, width;
};

/** Triangles, each with a reflectivity. The triangles are seen from both sides. */
class Mesh {
 public:
    struct Triangle {
        std::array<std::uint32_t, 3> corner;
        float reflectivity;
    };

    std::uint32_t addVertex(const Eigen::Vector3d& place);
    void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, double reflectivity);
    void addQuad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                 const Eigen::Vector3d& d, double reflectivity);
    /** From rectangle `low` at height z0 to `high` at z1: boxes, wedges, roofs. */
    void addFrustum(const Frame& frame, const Rectangle& low, double z0, const Rectangle& high,
                    double z1, double reflectivity);
    void addBox(const Frame& frame, const Rectangle& base, double z0, double z1,
                double reflectivity);
    /** An upright post with eight sides. */
    void addPost(const Frame& frame, double radiusLow, double radiusHigh, double z0, double z1,
                 double reflectivity);
    /** One small triangle of edge `size`, turned at random: leaves. */
    void addLeaf(const Eigen::Vector3d& centre, double size, double reflectivity, Random& random);

    const std::vector<Eigen::Vector3f>& vertices() const { return vertices_; }
    const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
    std::vector<Eigen::Vector3f> vertices_;
    std::vector<Triangle> triangles_;
};
}  // namespace delio::synth
