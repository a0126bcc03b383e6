#include "delio/places/stored_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/voxel_grid.h"
#include "core/voxel_table.h"
#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "formats/point_stream.h"
#include "places/descriptor.h"
#include "places/tiles.h"

namespace delio {
using places::kTile_m;

namespace {
constexpr double kDeg = M_PI / 180;

/** Median of a sample of the cloud's points: a few outliers do not move it. */
Eigen::Vector3d middleOf(const std::string& cloud) {
    constexpr std::size_t kMost = 8192;
    std::vector<Eigen::Vector3d> sample;
    std::size_t stride = 1, number = 0;
    io::forEachPoint(cloud, [&](const Eigen::Vector3d& point) {
        if (number++ % stride != 0) return;
        sample.push_back(point);
        if (sample.size() < kMost) return;
        for (std::size_t i = 0; i < kMost / 2; ++i) sample[i] = sample[2 * i];
        sample.resize(kMost / 2);
        stride *= 2;
    });
    if (sample.empty()) throw Error("'" + cloud + "' has no finite point");
    Eigen::Vector3d middle;
    for (Eigen::Index k = 0; k < 3; ++k) {
        const auto at = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
        std::nth_element(sample.begin(), at, sample.end(),
                         [k](const auto& a, const auto& b) { return a[k] < b[k]; });
        middle[k] = (*at)[k];
    }
    return middle;
}

/** Zero where the coordinates are small enough for floats; otherwise whole kilometres. */
Eigen::Vector3d offsetOf(const Eigen::Vector3d& middle) {
    constexpr double kNear_m = 20000, kStep_m = 1000;  // floats are good to 1 mm up to here
    if (middle.cwiseAbs().maxCoeff() <= kNear_m) return Eigen::Vector3d::Zero();
    return (middle / kStep_m).array().round() * kStep_m;
}

/** The first point in each voxel, less the offset. */
std::vector<Eigen::Vector3f> thinned(const std::string& cloud, double spacing_m,
                                     ImportFigures& figures) {
    constexpr double kFarthest_m = 50000;
    constexpr std::size_t kMost = 200'000'000;
    const Eigen::Vector3d middle = middleOf(cloud);
    figures.origin.offset = offsetOf(middle);
    VoxelIndex voxels;
    std::vector<Eigen::Vector3f> kept;
    figures.origin.wkt = io::forEachPoint(cloud, [&](const Eigen::Vector3d& point) {
        ++figures.points;
        if ((point - middle).cwiseAbs().maxCoeff() > kFarthest_m) {
            ++figures.outliers;
            return;
        }
        const Eigen::Vector3d here = point - figures.origin.offset;
        if (voxels.insert(voxelKey(here, spacing_m)) < kept.size()) return;
        if (kept.size() == kMost)
            throw Error("'" + cloud +
                        "' covers too much space: give a larger --spacing, or cut it");
        kept.push_back(here.cast<float>());
    });
    return kept;
}

/** A cloud in millimetres has a point or two per tile, and as many tiles as points. */
void checkDensity(const std::vector<Eigen::Vector3f>& points, const std::string& cloud) {
    constexpr std::size_t kFewest = 20;  // per tile; a point every 2 m on the ground is 225
    VoxelIndex tiles;
    for (const auto& point : points)
        tiles.insert(voxelKey(floorOf(point.x() / kTile_m), floorOf(point.y() / kTile_m), 0));
    if (points.size() < kFewest * tiles.size())
        throw Error("'" + cloud + "' has " + std::to_string(points.size() / tiles.size()) +
                    " points per square of 30 m: coordinates must be metres, and the ground must "
                    "have a point every 0.2 m");
}

/** A square of the cloud. */
struct Tile {
    std::vector<std::uint32_t> members;  //!< numbers of its points
    Eigen::Vector2d middle;
    paper::SurfaceNormals surfaces;
};

class CutCloud {
 public:
    explicit CutCloud(std::vector<Eigen::Vector3f> points);
    /** Throws Error where another axis than z is up: the cloud is flat along it, and more surfaces
     *  face it than z. LeGO-LOAM writes such maps. */
    void checkUp(const std::string& cloud) const;

    std::size_t size() const { return tiles_.size(); }
    const std::vector<Eigen::Isometry3d>& levelFrames() const { return level_; }
    /** The normal of most of the ground; the cloud's axis z without ground. */
    Eigen::Vector3d up() const { return up_; }
    /** Of a tile, in its level frame. */
    Eigen::Matrix3Xf pointsOf(std::size_t tile) const {
        return level_[tile].inverse().cast<float>() * inCloud(tile);
    }
    /** Empty where a vehicle has no place to stand. */
    places::Descriptor descriptorOf(std::size_t tile);
    std::size_t places() const { return places_; }  //!< descriptors that were not empty

 private:
    void cut();
    Eigen::Matrix3Xf inCloud(std::size_t tile) const;
    Eigen::Vector3d upOf(const Eigen::Vector3d& first, double cone_deg,
                         const Eigen::Vector2d& middle, double radius_m) const;
    double groundOf(std::size_t tile, const Eigen::Matrix3d& level) const;

    std::vector<Eigen::Vector3f> points_;
    std::vector<Tile> tiles_;
    Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();
    std::vector<Eigen::Isometry3d> level_;
    std::size_t places_ = 0;
};

CutCloud::CutCloud(std::vector<Eigen::Vector3f> points) : points_(std::move(points)) {
    constexpr double kSteepest_deg = 30, kSlope_deg = 10, kAround_m = 1.1 * kTile_m;
    cut();
    for (std::size_t i = 0; i < size(); ++i) {
        const Eigen::Matrix3Xf all = inCloud(i);
        const Eigen::Vector3f middle = all.rowwise().mean();
        tiles_[i].surfaces = places::flatVoxels(all.colwise() - middle);
    }
    up_ = upOf(up_, kSteepest_deg, {0, 0}, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < size(); ++i) {
        const auto& middle = tiles_[i].middle;
        const Eigen::Vector3d up = upOf(up_, kSlope_deg, middle, kAround_m);
        const Eigen::Matrix3d level =
            Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up).toRotationMatrix();
        level_.push_back(isometry(level, {middle.x(), middle.y(), groundOf(i, level)}));
    }
}

void CutCloud::checkUp(const std::string& cloud) const {
    constexpr double kFlat = 0.5, kCone_deg = 30;
    Eigen::Vector3d extent, facing = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < 3; ++k) {
        std::vector<float> values;
        for (const auto& point : points_) values.push_back(point[k]);
        const auto at = [&](double quantile) {
            const auto rank =
                static_cast<std::ptrdiff_t>(quantile * static_cast<double>(values.size() - 1));
            std::nth_element(values.begin(), values.begin() + rank, values.end());
            return double{values[static_cast<std::size_t>(rank)]};
        };
        extent[k] = at(0.95) - at(0.05);
        for (const auto& tile : tiles_) {
            const auto& surfaces = tile.surfaces;
            for (Eigen::Index i = 0; i < surfaces.directions.cols(); ++i)
                if (std::abs(surfaces.directions(k, i)) > std::cos(kCone_deg * kDeg))
                    facing[k] += static_cast<double>(surfaces.planarity[i]);
        }
    }
    for (Eigen::Index k = 0; k < 2; ++k)
        if (extent[k] < kFlat * std::min(extent[1 - k], extent.z()) && facing[k] > facing.z() &&
            facing.z() > 0)  // else it is a wall
            throw Error("'" + cloud + "' is flat along " + "xy"[k] +
                        ", as a map of LeGO-LOAM is: turn it so that z is up");
}

/** Into tiles in the order of their rows. */
void CutCloud::cut() {
    const auto keyOf = [&](std::uint32_t i) {
        const Eigen::Vector2d at = points_[i].head<2>().cast<double>() / kTile_m;
        return voxelKey(floorOf(at.y()), floorOf(at.x()), 0);
    };
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return keyOf(a) < keyOf(b); });
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || keyOf(order[i]) != keyOf(order[i - 1])) {
            const Eigen::Vector2d at = points_[order[i]].head<2>().cast<double>();
            tiles_.emplace_back().middle = ((at / kTile_m).array().floor() + 0.5) * kTile_m;
        }
        tiles_.back().members.push_back(order[i]);
    }
}

Eigen::Matrix3Xf CutCloud::inCloud(std::size_t tile) const {
    const auto& members = tiles_[tile].members;
    Eigen::Matrix3Xf points(3, static_cast<Eigen::Index>(members.size()));
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        points.col(i) = points_[members[static_cast<std::size_t>(i)]];
    return points;
}

/** Mean of the normals about `first`, in cones that become narrower. */
Eigen::Vector3d CutCloud::upOf(const Eigen::Vector3d& first, double cone_deg,
                               const Eigen::Vector2d& middle, double radius_m) const {
    constexpr double kNarrowest_deg = 5;
    Eigen::Vector3d up = first;
    for (double cone = cone_deg; cone >= kNarrowest_deg; cone /= 1.4) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const auto& tile : tiles_) {
            if ((tile.middle - middle).cwiseAbs().maxCoeff() > radius_m) continue;
            const auto& surfaces = tile.surfaces;
            for (Eigen::Index i = 0; i < surfaces.directions.cols(); ++i) {
                const Eigen::Vector3d normal = surfaces.directions.col(i).cast<double>();
                const double along = normal.dot(up);
                if (std::abs(along) < std::cos(cone * kDeg)) continue;
                sum += static_cast<double>(surfaces.planarity[i]) * (along > 0 ? normal : -normal);
            }
        }
        if (sum.norm() > 0) up = sum.normalized();
    }
    return up;
}

/** Height of a tile's ground in the middle of the tile, metres. */
double CutCloud::groundOf(std::size_t tile, const Eigen::Matrix3d& level) const {
    const Eigen::Vector3d up = level.col(2);
    std::vector<double> heights;
    for (const auto i : tiles_[tile].members) {
        const Eigen::Vector3d point = points_[i].cast<double>();
        const Eigen::Vector2d off = point.head<2>() - tiles_[tile].middle;
        heights.push_back(point.z() + up.head<2>().dot(off) / up.z());
    }
    const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 10);
    std::nth_element(heights.begin(), low, heights.end());
    return *low;
}

/** True if a vehicle can stand in a tile: enough ground without anything up to 2 m above it. */
bool isPlace(const places::HeightImage& image, const Eigen::Matrix3Xf& tile) {
    constexpr double kCell_m = places::HeightImage::kCell_m, kLow_m = 0.3, kLeast_m2 = 15;
    constexpr std::uint8_t kInTheWay = 1 | 2;  // 0.3 to 1 m, and 1 to 2 m
    const auto cellAt = [](double x, double y) {
        return voxelKey(floorOf(x / kCell_m), floorOf(y / kCell_m), 0);
    };
    VoxelIndex blocked, bare;
    const auto cells = image.cells();
    for (Eigen::Index i = 0; i < cells.cols(); ++i)
        if ((image.bands()[static_cast<std::size_t>(i)] & kInTheWay) != 0)
            blocked.insert(cellAt(cells(0, i), cells(1, i)));
    for (Eigen::Index i = 0; i < tile.cols(); ++i) {
        const Eigen::Vector3d point = tile.col(i).cast<double>();
        const auto cell = cellAt(point.x(), point.y());
        if (point.z() - image.groundAt(point.x(), point.y()) < kLow_m &&
            blocked.find(cell) == VoxelIndex::kNone)
            bare.insert(cell);
    }
    return static_cast<double>(bare.size()) * kCell_m * kCell_m >= kLeast_m2;
}

places::Descriptor CutCloud::descriptorOf(std::size_t tile) {
    const auto around =
        places::surroundings(tile, level_, [this](std::size_t i) { return pointsOf(i); });
    places::Descriptor descriptor(around);
    if (!isPlace(descriptor.image, pointsOf(tile)))
        return places::Descriptor(Eigen::Matrix3Xf(3, 0));
    ++places_;
    return descriptor;
}

/** A node for each tile. Edges keep the cloud as it is when the map is extended by a drive. */
MapContent contentOf(CutCloud& cloud, const CloudOrigin& origin) {
    constexpr double kRigid = 1e-8;  // variance, m^2 and rad^2
    MapContent content;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
        const auto& level = cloud.levelFrames();
        content.graph.addNode(level[i]);
        if (i > 0)
            content.graph.addEdge(
                {i - 1, i, {level[i - 1].inverse() * level[i], kRigid * Matrix6::Identity()}});
        places::Submap submap;
        submap.first = submap.key = submap.last = i;
        submap.points.resize(3, 0);
        content.submaps.push_back(submap);
    }
    content.points = [&](std::size_t i) { return cloud.pointsOf(i); };
    content.cloud = origin;
    return content;
}
}  // namespace

ImportFigures importCloud(const std::string& path, std::optional<double> spacing_m,
                          const std::string& map) {
    constexpr double kSpacing_m = 0.3;
    constexpr std::size_t kSmall = 200'000;
    ImportFigures figures;
    auto points = thinned(path, spacing_m.value_or(kSpacing_m), figures);
    if (!spacing_m && points.size() < kSmall) {
        figures = {};
        points = thinned(path, kSpacing_m / 2, figures);
    }
    figures.kept = points.size();
    checkDensity(points, path);
    CutCloud cloud(std::move(points));
    cloud.checkUp(path);
    figures.submaps = figures.origin.tiles = cloud.size();
    figures.tilt_deg = std::acos(std::min(1.0, cloud.up().z())) / kDeg;
    auto content = contentOf(cloud, figures.origin);
    content.descriptor = [&](std::size_t i) {
        auto descriptor = cloud.descriptorOf(i);
        if (i + 1 == cloud.size() && cloud.places() == 0)
            throw Error("'" + path + "' has no free ground: coordinates must be metres, with z up");
        return descriptor;
    };
    StoredMap::save(content, map);
    figures.places = cloud.places();
    return figures;
}
}  // namespace delio
