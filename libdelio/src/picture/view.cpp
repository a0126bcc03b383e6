#include "picture/view.h"

#include <mrpt/opengl/CCamera.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CPointCloud.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <unordered_map>
#include <utility>

#include "delio/core/error.h"
#include "delio/core/geometry.h"
#include "delio/picture/render.h"

namespace delio::picture {
using Eigen::Isometry3d;
using Eigen::Vector3d;
using mrpt::opengl::CPointCloudColoured;
using mrpt::opengl::CRenderizable;

namespace {
constexpr std::size_t kMaxSamples = 200000;

/** Where an object's own point lies in the scene; left out if that is nowhere. */
void add(const mrpt::math::TPoint3D& point, const Isometry3d& pose, std::vector<Vector3d>& to) {
    const Vector3d at = pose * Vector3d(point.x, point.y, point.z);
    if (at.allFinite()) to.push_back(at);
}

template <typename Cloud>
void sample(const Cloud& cloud, const Isometry3d& pose, Content& content) {
    content.cloudSize += cloud.size();
    const std::size_t step = cloud.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < cloud.size(); i += step)
        add(mrpt::math::TPoint3D(cloud.getPoint3Df(i)), pose, content.points);
}

void sampleLines(const mrpt::opengl::CSetOfLines& lines, const Isometry3d& pose,
                 std::vector<Vector3d>& to) {
    const std::size_t step = lines.size() / kMaxSamples + 1;
    for (std::size_t i = 0; i < lines.size(); i += step) {
        const auto& line = lines.begin()[static_cast<std::ptrdiff_t>(i)];
        add(line.point1, pose, to);
        add(line.point2, pose, to);
    }
}

/** Corners of the box around an object: for what is neither points nor lines. */
void addBox(const CRenderizable& object, const Isometry3d& pose, std::vector<Vector3d>& to) {
    const auto box = object.getBoundingBoxLocal();
    for (int corner = 0; corner < 8; ++corner)
        add({corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
             corner & 4 ? box.max.z : box.min.z},
            pose, to);
}

void collect(const CRenderizable::Ptr& object, const Isometry3d& parent, Content& content) {
    const Isometry3d pose = parent * fromMrpt(mrpt::poses::CPose3D(object->getPose()));
    if (!object->isVisible() || object->getName() == kRemovedName) return;
    if (const auto set = std::dynamic_pointer_cast<mrpt::opengl::CSetOfObjects>(object)) {
        for (const auto& child : *set) collect(child, pose, content);
    } else if (const auto coloured =
                   std::dynamic_pointer_cast<mrpt::opengl::CPointCloudColoured>(object)) {
        sample(*coloured, pose, content);
    } else if (const auto plain = std::dynamic_pointer_cast<mrpt::opengl::CPointCloud>(object)) {
        sample(*plain, pose, content);
    } else if (const auto lines = std::dynamic_pointer_cast<mrpt::opengl::CSetOfLines>(object)) {
        sampleLines(*lines, pose, content.lines);
    } else if (std::dynamic_pointer_cast<mrpt::opengl::CGridPlaneXY>(object)) {
        addBox(*object, pose, content.grids);
    } else if (!std::dynamic_pointer_cast<mrpt::opengl::CCamera>(object)) {
        addBox(*object, pose, content.lines);
    }
}

constexpr double kDeg = M_PI / 180;
constexpr double kMargin = 1.05;   // the content fills the picture but for this
constexpr double kStrays = 0.001;  // points on either side that may be outside

/** Smallest and largest value, of points without the outermost thousandth on either side. */
template <typename Value>
std::pair<double, double> span(const Content& content, const Value& value) {
    double low = std::numeric_limits<double>::max(), high = -low;
    if (!content.points.empty()) {
        std::vector<double> values;
        values.reserve(content.points.size());
        for (const auto& p : content.points) values.push_back(value(p));
        const auto last = static_cast<double>(values.size() - 1);
        const auto at = [&](double share) {
            const auto it = values.begin() + std::lround(share * last);
            std::nth_element(values.begin(), it, values.end());
            return *it;
        };
        low = at(kStrays);
        high = at(1 - kStrays);
    }
    for (const auto& p : content.lines) {
        low = std::min(low, value(p));
        high = std::max(high, value(p));
    }
    return {low, high};
}

/** Azimuth that lays the longer horizontal side of the content across the picture. Seen straight
 *  from above only by right angles, so that the grid stays straight. */
double acrossAzimuth_deg(const Content& content, bool fromAbove) {
    if (fromAbove) {
        const auto [xMin, xMax] = span(content, [](const Vector3d& p) { return p.x(); });
        const auto [yMin, yMax] = span(content, [](const Vector3d& p) { return p.y(); });
        return xMax - xMin >= yMax - yMin ? -90 : 180;
    }
    const auto& places = content.points.size() > 100 ? content.points : content.lines;
    Eigen::Vector2d mean(0, 0);
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const auto& p : places) mean += p.head<2>();
    mean /= static_cast<double>(std::max<std::size_t>(places.size(), 1));
    for (const auto& p : places) scatter += (p.head<2>() - mean) * (p.head<2>() - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(scatter);
    const Eigen::Vector2d across = axes.eigenvectors().col(1);
    const double azimuth = std::atan2(across.x(), -across.y()) / kDeg;
    // One of the two sides, always the same one: that of -y, so that +x points right.
    return azimuth > 0 ? azimuth - 180 : azimuth;
}

std::function<double(const Vector3d&)> along(const Vector3d& axis) {
    return [axis](const Vector3d& p) { return axis.dot(p); };
}

View viewFrom(double azimuth_deg, double elevation_deg) {
    View view;
    const double az = azimuth_deg * kDeg, el = elevation_deg * kDeg;
    view.right = {-std::sin(az), std::cos(az), 0};
    view.back = {std::cos(az) * std::cos(el), std::sin(az) * std::cos(el), std::sin(el)};
    view.up = view.back.cross(view.right);
    return view;
}

/** Half of the visible width and height at a distance of 1. */
struct Lens {
    explicit Lens(const SnapshotOptions& options)
        : aspect(double(options.width_px) / options.height_px),
          tanY(std::tan(kVerticalView_deg * kDeg / 2)),
          tanX(tanY * aspect) {}
    double aspect, tanY, tanX;
};

/** Distance from the view's middle from which all content is seen in perspective. */
double distanceFor(const Content& content, const View& view, const Lens& lens) {
    const auto needed = [&](const Vector3d& p) {
        const Vector3d q = p - view.middle;
        return view.back.dot(q) + std::max(std::abs(view.right.dot(q)) / lens.tanX,
                                           std::abs(view.up.dot(q)) / lens.tanY);
    };
    return std::max(span(content, needed).second, 0.2) * kMargin;
}

/** Lets the content fill the picture. */
void frame(View& view, const Content& content, const SnapshotOptions& options) {
    const Lens lens(options);
    const auto [left, right] = span(content, along(view.right));
    const auto [bottom, top] = span(content, along(view.up));
    const auto [behind, front] = span(content, along(view.back));
    view.middle = view.right * (left + right) / 2 + view.up * (bottom + top) / 2 +
                  view.back * (behind + front) / 2;
    view.metresAcross = std::max({right - left, (top - bottom) * lens.aspect, 0.1}) * kMargin;
    if (options.ortho) return;
    // Perspective moves what is near outwards: step back until everything fits, centre, repeat.
    for (int round = 0; round < 4; ++round) {
        view.distance = distanceFor(content, view, lens);
        for (const Vector3d& axis : {view.right, view.up}) {
            const auto [low, high] = span(content, [&](const Vector3d& p) {
                const Vector3d q = p - view.middle;
                return axis.dot(q) / std::max(view.distance - view.back.dot(q), 0.1);
            });
            view.middle += axis * (low + high) / 2 * view.distance;
        }
    }
    view.metresAcross = 2 * lens.tanX * view.distance;
}

/** Lets the content fit into every one of the views, all about one middle and of one size. */
void frameAll(std::vector<View>& views, const Content& content, const SnapshotOptions& options) {
    const Lens lens(options);
    Vector3d middle;
    for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] = span(content, along(Vector3d::Unit(axis)));
        middle[axis] = (low + high) / 2;
    }
    double metresAcross = 0.1;
    for (auto& view : views) {
        view.middle = middle;
        double across = 2 * lens.tanX * distanceFor(content, view, lens);
        if (options.ortho) {
            const auto [least, most] = span(content, [&](const Vector3d& p) {
                const Vector3d q = p - middle;
                return std::max(std::abs(view.right.dot(q)),
                                std::abs(view.up.dot(q)) * lens.aspect);
            });
            across = 2 * most * kMargin;
        }
        metresAcross = std::max(metresAcross, across);
    }
    for (auto& view : views) view.metresAcross = metresAcross;
}

void setDepths(View& view, const Content& content, const SnapshotOptions& options) {
    if (options.zoom_m) {
        view.magnification = view.metresAcross / *options.zoom_m;
        view.metresAcross = *options.zoom_m;
    }
    view.distance = distanceOf(view, options);
    // Strays do not count here either: MRPT keeps the camera's place in floats, so a camera that
    // stands far off looks past its content.
    const auto height = [&](const Vector3d& p) { return view.back.dot(p - view.middle); };
    auto [deepest, closest] = span(content, height);
    for (const auto& p : content.grids) {
        deepest = std::min(deepest, height(p));
        closest = std::max(closest, height(p));
    }
    const double slack = 10 + 0.5 * (closest - deepest);
    // In parallel projection the camera's distance shows nowhere: let it be in front of everything.
    if (options.ortho) view.distance = std::max(view.distance, closest + 2 * slack);
    view.nearest = view.distance - closest - slack;
    view.farthest = view.distance - deepest + slack;
}
/** In how full a cell a typical point lies. */
double pointsPerCell(const CPointCloudColoured& cloud, double cell_m) {
    std::unordered_map<std::uint64_t, std::uint32_t> counts;
    std::vector<std::uint64_t> cells(cloud.size());
    const auto part = [&](float v) {
        constexpr std::int64_t kHalf = 1 << 20;
        const double at = std::clamp(std::floor(double{v} / cell_m), -1.0 * kHalf, kHalf - 1.0);
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(at) + kHalf);
    };
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto& p = cloud.getPoint3Df(i);
        if (!std::isfinite(p.x + p.y + p.z)) continue;
        cells[i] = part(p.x) << 42 | part(p.y) << 21 | part(p.z);
        ++counts[cells[i]];
    }
    std::vector<std::uint32_t> fullness;
    fullness.reserve(cells.size());
    for (const auto cell : cells) fullness.push_back(counts[cell]);
    const auto middle = fullness.begin() + static_cast<std::ptrdiff_t>(fullness.size() / 2);
    std::nth_element(fullness.begin(), middle, fullness.end());
    return *middle;
}
}  // namespace

Content contentOf(const mrpt::opengl::COpenGLScene& scene) {
    Content content;
    for (const auto& object : *scene.getViewport())
        collect(object, Isometry3d::Identity(), content);
    return content;
}

double nearClipOf(const View& view) { return std::max(view.nearest, 1e-3 * view.farthest); }

double distanceOf(const View& view, const SnapshotOptions& options) {
    return view.metresAcross / (2 * Lens(options).tanX);
}

std::vector<View> viewsOf(const Content& content, const SnapshotOptions& options,
                          unsigned pictures) {
    const double first = options.azimuth_deg
                             ? *options.azimuth_deg
                             : acrossAzimuth_deg(content, options.elevation_deg == 90);
    std::vector<View> views;
    for (unsigned i = 0; i < pictures; ++i)
        views.push_back(viewFrom(first + 360.0 * i / pictures, options.elevation_deg));
    if (pictures == 1)
        frame(views[0], content, options);
    else
        frameAll(views, content, options);
    constexpr double kFarthest_m = 1e9;  // MRPT counts in floats
    for (auto& view : views) {
        setDepths(view, content, options);
        if (!(view.farthest < kFarthest_m))
            throw Error("what it shows is too far apart for a picture: more than 1e9 m");
    }
    return views;
}

SnapshotOptions topView() {
    SnapshotOptions options;
    options.elevation_deg = 90;
    options.ortho = true;
    options.scaleBar = true;
    return options;
}

double mapSpacing_m(mrpt::opengl::COpenGLScene& scene) {
    const auto cloud = std::dynamic_pointer_cast<CPointCloudColoured>(scene.getByName(kMapName));
    if (!cloud || cloud->empty()) return 0;
    constexpr double kEnough = 12, kSmallest_m = 0.25, kLargest_m = 64;
    for (double cell_m = kSmallest_m; cell_m <= kLargest_m; cell_m *= 2)
        if (const double points = pointsPerCell(*cloud, cell_m); points >= kEnough)
            return cell_m / std::sqrt(points);
    return 0;
}
}  // namespace delio::picture
