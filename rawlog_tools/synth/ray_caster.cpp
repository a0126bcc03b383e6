#include "ray_caster.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "delio/core/error.h"

namespace delio::synth {
namespace {
void check(RTCDevice device, const std::string& what) {
    const RTCError code = rtcGetDeviceError(device);
    if (code != RTC_ERROR_NONE)
        throw Error("Embree failed " + what + " (error " + std::to_string(code) + ")");
}
}  // namespace

RayCaster::RayCaster() : device_(rtcNewDevice("threads=1,isa=sse4.2")) {
    if (!device_) throw Error("Embree cannot start on this machine: it needs SSE 4.2");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    check(device_, "to make a scene");
}

RayCaster::~RayCaster() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void RayCaster::add(int id, Mesh mesh) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto& vertices = mesh.vertices();
    const auto& triangles = mesh.triangles();
    auto* corners = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), vertices.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), triangles.size()));
    check(device_, "to hold a tile of the scene");
    for (const auto& v : vertices) corners = std::copy(v.data(), v.data() + 3, corners);
    for (const auto& t : triangles) indices = std::copy(t.corner.begin(), t.corner.end(), indices);
    rtcCommitGeometry(geometry);
    const unsigned number = rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    meshes_.insert_or_assign(id, Attached{number, std::move(mesh)});
}

void RayCaster::remove(int id) {
    rtcDetachGeometry(scene_, meshes_.at(id).geometry);
    meshes_.erase(id);
}

std::vector<int> RayCaster::ids() const {
    std::vector<int> all;
    for (const auto& [id, attached] : meshes_) all.push_back(id);
    return all;
}

void RayCaster::commit() {
    rtcCommitScene(scene_);
    check(device_, "to build the scene");
    byGeometry_.clear();
    for (const auto& [id, attached] : meshes_) {
        if (attached.geometry >= byGeometry_.size()) byGeometry_.resize(attached.geometry + 1);
        byGeometry_[attached.geometry] = &attached.mesh;
    }
}

Hit RayCaster::exactHit(const Ray& ray, unsigned geometry, unsigned triangle, double found) const {
    const Mesh& mesh = *byGeometry_[geometry];
    const auto& t = mesh.triangles()[triangle];
    const auto corner = [&](std::size_t i) -> Eigen::Vector3d {
        return mesh.vertices()[t.corner[i]].cast<double>();
    };
    const Eigen::Vector3d a = corner(0);
    const Eigen::Vector3d normal = (corner(1) - a).cross(corner(2) - a).normalized();
    const double along = normal.dot(ray.direction);
    Hit hit{found, std::abs(along), t.reflectivity};
    // A triangle seen edge-on has no well-defined crossing: Embree's stands.
    const double exact = normal.dot(a - ray.origin) / along;
    if (std::abs(exact - found) < 0.01) hit.range = exact;
    return hit;
}

void RayCaster::cast(const Eigen::Vector3d& origin, const std::vector<Eigen::Vector3d>& directions,
                     double maxRange, std::vector<Hit>& hits) const {
    std::vector<Ray> rays;
    rays.reserve(directions.size());
    for (const auto& direction : directions) rays.push_back({origin, direction});
    cast(rays, maxRange, hits);
}

void RayCaster::cast(const std::vector<Ray>& all, double maxRange, std::vector<Hit>& hits) const {
    constexpr std::size_t kPacket = 4;  // what SSE holds
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    hits.assign(all.size(), Hit{});
    for (std::size_t begin = 0; begin < all.size(); begin += kPacket) {
        const std::size_t count = std::min(kPacket, all.size() - begin);
        alignas(16) RTCRayHit4 rays{};
        alignas(16) int valid[kPacket] = {};
        for (std::size_t i = 0; i < count; ++i) {
            const Eigen::Vector3f from = all[begin + i].origin.cast<float>();
            const Eigen::Vector3f d = all[begin + i].direction.cast<float>();
            valid[i] = -1;
            rays.ray.org_x[i] = from.x();
            rays.ray.org_y[i] = from.y();
            rays.ray.org_z[i] = from.z();
            rays.ray.dir_x[i] = d.x();
            rays.ray.dir_y[i] = d.y();
            rays.ray.dir_z[i] = d.z();
            rays.ray.tfar[i] = static_cast<float>(maxRange);
            rays.ray.mask[i] = ~0U;
            rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect4(valid, scene_, &context, &rays);
        for (std::size_t i = 0; i < count; ++i)
            if (rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
                hits[begin + i] = exactHit(all[begin + i], rays.hit.geomID[i], rays.hit.primID[i],
                                           rays.ray.tfar[i]);
    }
}
}  // namespace delio::synth
