#include "delio/picture/figures.h"

#include <mrpt/opengl/CCylinder.h>
#include <mrpt/opengl/CPointCloudColoured.h>
#include <mrpt/opengl/CSetOfLines.h>
#include <mrpt/opengl/CText3D.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "delio/map/colouring.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "odometry/preprocess.h"
#include "paper/line_registration.h"
#include "paper/normals.h"
#include "paper/outlier_removal.h"
#include "picture/legend.h"
#include "picture/line_scenes.h"

namespace delio::picture {
using mrpt::img::TColor;
using mrpt::img::TColorf;
using mrpt::opengl::COpenGLScene;

namespace {
constexpr double kSpacing = 2.4;  // of the spheres, whose radius is 1
constexpr double kSphereElevation_deg = 25;
constexpr double kPiece_m = 0.04;
constexpr float kWidth_px = 2;
const TColor kWhite(255, 255, 255), kInk(40, 40, 40), kGridGray(190, 190, 195);
const TColor kBlue(31, 119, 180), kRed(214, 39, 40), kGreen(44, 160, 44);

COpenGLScene::Ptr emptyScene() {
    auto scene = COpenGLScene::Create();
    scene->getViewport()->setCustomBackgroundColor(TColorf(kWhite));
    return scene;
}

mrpt::opengl::CSetOfLines::Ptr linesOf(const paper::LineCloud& lines, const Eigen::Vector3d& t,
                                       const TColor& colour, double piece_m = kPiece_m) {
    auto set = wideLines(colour, kWidth_px);
    for (Eigen::Index i = 0; i < lines.midpoints.cols(); ++i) {
        const Eigen::Vector3d half =
            (lines.lengths[i] / 2 * lines.directions.col(i)).cast<double>();
        const Eigen::Vector3d middle = lines.midpoints.col(i).cast<double>() + t;
        appendWide(*set, middle - half, middle + half, piece_m);
    }
    return set;
}

/** Circles of latitude and longitude, every 30 deg, on the unit sphere. */
mrpt::opengl::CSetOfLines::Ptr globeLines() {
    auto lines = mrpt::opengl::CSetOfLines::Create();
    const auto at = [](int latitude, int longitude) {
        const double v = latitude * M_PI / 180, u = longitude * M_PI / 180;
        return mrpt::math::TPoint3D(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u),
                                    std::sin(v));
    };
    constexpr int kStep = 5, kBetween = 30;
    for (int a = -90; a < 90; a += kStep)
        for (int b = 0; b < 360; b += kStep) {
            if (b % kBetween == 0) lines->appendLine(at(a, b), at(a + kStep, b));
            if (a % kBetween == 0) lines->appendLine(at(a, b), at(a, b + kStep));
        }
    lines->setColor_u8(kGridGray);
    return lines;
}

/** Paler where sphereView() sees the far side of the sphere. */
TColor seenAt(const Eigen::Vector3f& n, const TColor& colour) {
    static const double kElevation = kSphereElevation_deg * M_PI / 180;
    if (double{n.z()} * std::sin(kElevation) >= double{n.x()} * std::cos(kElevation)) return colour;
    const auto pale = [](int v) { return static_cast<std::uint8_t>(255 - (255 - v) / 2); };
    return {pale(colour.R), pale(colour.G), pale(colour.B)};
}

/** Directions on the unit sphere, in one colour or coloured by their place. */
mrpt::opengl::CPointCloudColoured::Ptr dotsOf(const Eigen::Matrix3Xf& pattern, float size_px = 3,
                                              const std::optional<TColor>& colour = {}) {
    auto dots = mrpt::opengl::CPointCloudColoured::Create();
    const auto byte = [](float v) { return static_cast<std::uint8_t>(110 + 100 * v); };
    for (Eigen::Index i = 0; i < pattern.cols(); ++i) {
        const Eigen::Vector3f n = pattern.col(i);
        const TColor own(byte(n.x()), byte(n.y()), byte(n.z()));
        const TColor c = seenAt(n, colour.value_or(own));
        dots->insertPoint({n.x(), n.y(), n.z(), c.R, c.G, c.B});
    }
    dots->setPointSize(size_px);
    dots->enableVariablePointSize(false);
    return dots;
}

/** The sphere at this place in sphereScene(). */
void addToSphere(COpenGLScene& scene, std::size_t sphere,
                 const mrpt::opengl::CRenderizable::Ptr& object) {
    object->setLocation(0, -kSpacing * static_cast<double>(sphere), 0);  // y is to the left
    scene.insert(object);
}

using mrpt::img::CImage;

CImage sideBySide(const CImage& left, const CImage& right) {
    CImage sheet;
    sheet.resize(left.getWidth() + right.getWidth(), left.getHeight(), mrpt::img::CH_RGB);
    sheet.drawImage(0, 0, left);
    sheet.drawImage(static_cast<int>(left.getWidth()), 0, right);
    return sheet;
}

MapWays waysOf(const run::RunRecord& record, std::vector<Eigen::Isometry3d> trajectory) {
    MapWays ways{std::move(trajectory), record.truth, {}, record.closedLoops()};
    if (record.georeference) ways.north = record.georeference->north();
    return ways;
}

void drawMap(const run::RunRecord& record, const map::BuiltMap& map, const run::RunFolder& folder) {
    MapWays ways = waysOf(record, record.final.poses);
    ways.keyframes = map.keyPoses;
    const auto scene = mapScene(map.points, ways);
    saveScene(*scene, folder.path(run::RunFolder::kScene));
    SnapshotOptions view;
    view.scaleBar = view.northArrow = true;
    savePicture(*scene, view, folder.path(run::RunFolder::kMapPicture));
}

void drawRemoval(const run::RunRecord& record, const map::BuiltMap& map, const std::string& path) {
    const auto pictureOf = [&](const std::string& caption, bool before) {
        SceneOptions options;
        options.colormap = map::Colormap::Gray;  // has no red
        options.caption = caption;
        const auto scene = mapScene(map.points, {record.final.poses, {}, {}, {}}, options);
        if (before) addRemoved(*scene, map.dynamic);
        return picture(*scene, {});
    };
    const std::string removed = std::to_string(map.dynamic.size()) + " points of what moved";
    savePng(sideBySide(pictureOf("before: in red " + removed, true),
                       pictureOf("after: without " + removed, false)),
            path);
}

void drawTrajectory(const run::RunRecord& record, const std::string& path) {
    auto view = topView();
    view.northArrow = true;
    const auto pictureOf = [&](const io::Trajectory& trajectory, const char* name) {
        return picture(*trajectoryScene(waysOf(record, trajectory.poses), name), view);
    };
    savePng(record.optimised() ? sideBySide(pictureOf(record.odometry, "unoptimised"),
                                            pictureOf(record.final, "optimised"))
                               : pictureOf(record.final, "estimate"),
            path);
}
}  // namespace

COpenGLScene::Ptr sphereScene(const std::vector<Eigen::Matrix3Xf>& patterns,
                              const std::vector<std::string>& captions) {
    auto scene = emptyScene();
    for (std::size_t i = 0; i < patterns.size(); ++i) {
        addToSphere(*scene, i, globeLines());
        auto dots = dotsOf(patterns[i]);
        dots->setName("pattern_" + std::to_string(i));
        addToSphere(*scene, i, dots);
        if (i >= captions.size()) continue;
        auto text = mrpt::opengl::CText3D::Create(captions[i], "sans", 0.16);
        text->setColor_u8(kInk);
        // Upright, to be read by who looks along +x.
        constexpr double kHalfLetter = 0.065;
        const double begin = kHalfLetter * static_cast<double>(captions[i].size()) -
                             kSpacing * static_cast<double>(i);
        text->setPose(mrpt::poses::CPose3D(0, begin, -1.35, -M_PI / 2, 0, M_PI / 2));
        scene->insert(text);
    }
    return scene;
}

SnapshotOptions sphereView(std::size_t spheres) {
    SnapshotOptions options;
    options.width_px = static_cast<unsigned>(500 * std::max<std::size_t>(spheres, 1));
    options.height_px = 500;
    options.azimuth_deg = 180;
    options.elevation_deg = kSphereElevation_deg;
    options.ortho = true;
    return options;
}

COpenGLScene::Ptr meanShiftScene(const Eigen::Matrix3Xf& normals, const Eigen::Matrix3Xf& seeds,
                                 const std::vector<paper::Mode>& modes, double window_deg,
                                 const Eigen::Matrix3Xf& pattern) {
    const std::string count = std::to_string(modes.size());
    auto scene = sphereScene({normals, normals, pattern}, {std::to_string(seeds.cols()) + " seeds",
                                                           count + " windows", count + " modes"});
    addToSphere(*scene, 0, dotsOf(seeds, 3, kInk));
    const double radius = window_deg / 2 * M_PI / 180;
    Eigen::Matrix3Xf directions(3, static_cast<Eigen::Index>(modes.size()));
    Eigen::Index i = 0;
    for (const auto& mode : modes) {
        const Eigen::Vector3d& n = mode.direction;
        const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
        auto circle = wideLines(seenAt(n.cast<float>(), kRed), kWidth_px);
        const auto at = [&](int deg) -> Eigen::Vector3d {
            const double t = deg * M_PI / 180;
            return std::cos(radius) * n + std::sin(radius) * (std::cos(t) * u + std::sin(t) * v);
        };
        for (int deg = 0; deg < 360; deg += 10) appendWide(*circle, at(deg), at(deg + 10), 0.01);
        addToSphere(*scene, 1, circle);
        directions.col(i++) = n.cast<float>();
    }
    addToSphere(*scene, 2, dotsOf(directions, 6, kRed));
    return scene;
}

paper::LineCloud someOf(const paper::LineCloud& lines, const std::vector<Eigen::Index>& which) {
    return {lines.midpoints(Eigen::all, which), lines.directions(Eigen::all, which),
            lines.lengths(which), lines.drawn};
}

COpenGLScene::Ptr lineScene(const paper::LineCloud& lines) {
    auto scene = emptyScene();
    const Eigen::Index count = lines.midpoints.cols();
    std::vector<float> heights(static_cast<std::size_t>(count));
    for (Eigen::Index i = 0; i < count; ++i)
        heights[static_cast<std::size_t>(i)] = lines.midpoints(2, i);
    const auto range = map::robustRange(heights);
    // A set of lines has one colour: one set for each band of height.
    constexpr int kBands = 16;
    for (int band = 0; band < kBands; ++band) {
        std::vector<Eigen::Index> inside;
        for (Eigen::Index i = 0; i < count; ++i) {
            const double fraction = range.fractionAt(static_cast<double>(lines.midpoints(2, i)));
            if (std::min(kBands - 1, static_cast<int>(fraction * kBands)) == band)
                inside.push_back(i);
        }
        const auto some = someOf(lines, inside);
        const TColor colour = map::colourAt(map::Colormap::Turbo, (band + 0.5) / kBands);
        scene->insert(linesOf(some, Eigen::Vector3d::Zero(), colour));
    }
    addColourBar(*scene, 0, map::Colormap::Turbo, range, " m", "height", kInk);
    return scene;
}

COpenGLScene::Ptr matchScene(const paper::LineCloud& from, const paper::LineCloud& to,
                             const Eigen::Vector3d& t) {
    auto scene = emptyScene();
    scene->insert(linesOf(from, Eigen::Vector3d::Zero(), kBlue));
    scene->insert(linesOf(to, t, kRed));
    const auto matches = paper::LineMatcher(from).matches(to, t, 5);
    const double mean = paper::meanDistance(matches);
    auto joins = wideLines(kGreen, kWidth_px);
    for (std::size_t i = 0; i < matches.size(); ++i) {
        if (matches[i].distance < 0 || static_cast<double>(matches[i].distance) > mean) continue;
        const Eigen::Vector3d moved =
            to.midpoints.col(static_cast<Eigen::Index>(i)).cast<double>() + t;
        const Eigen::Vector3d paired = from.midpoints.col(matches[i].from).cast<double>();
        // Above the lines that it joins, to be seen from there.
        const Eigen::Vector3d above(0, 0, 0.3);
        appendWide(*joins, moved + above, paired + above, kPiece_m);
    }
    scene->insert(joins);
    addLegendText(*scene, 2, "first scan", kBlue);
    addLegendText(*scene, 1, "second scan", kRed);
    addLegendText(*scene, 0, "pairs", kGreen);
    return scene;
}

void addCircle(COpenGLScene& scene, const Eigen::Vector3d& middle, double radius_m) {
    auto circle = wideLines(kGridGray, kWidth_px / 2);
    const auto at = [&](int deg) -> Eigen::Vector3d {
        const double angle = deg * M_PI / 180;
        return middle + radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    };
    for (int deg = 0; deg < 360; deg += 2) appendWide(*circle, at(deg), at(deg + 2), kPiece_m);
    scene.insert(circle);
}

COpenGLScene::Ptr binScene(const Eigen::Matrix3Xf& points, const Eigen::Matrix3Xf& outline,
                           const paper::LineCloud& drawn, const paper::LineCloud& kept) {
    auto scene = emptyScene();
    auto dots = mrpt::opengl::CPointCloudColoured::Create();
    for (Eigen::Index i = 0; i < points.cols(); ++i)
        dots->insertPoint({points(0, i), points(1, i), points(2, i), 90, 90, 90});
    dots->setPointSize(2);
    scene->insert(dots);
    // The kept ones are among all; they cover themselves from above.
    const auto add = [&](const paper::LineCloud& lines, double above_m, const TColor& colour,
                         float width_px) {
        const auto set = linesOf(lines, {0, 0, above_m}, colour, kPiece_m / 4);
        set->setVerticesPointSize(width_px);
        scene->insert(set);
    };
    add(drawn, 0, kRed, kWidth_px / 2);
    add(kept, 0.1, kGreen, kWidth_px);
    auto bin = wideLines(kBlue, 2 * kWidth_px);
    const Eigen::Vector3d above(0, 0, 0.2);
    for (Eigen::Index i = 0; i < outline.cols(); ++i)
        appendWide(*bin, outline.col(i).cast<double>() + above,
                   outline.col((i + 1) % outline.cols()).cast<double>() + above, kPiece_m / 2);
    scene->insert(bin);
    addLegendText(*scene, 3, "rings", kInk);
    addLegendText(*scene, 2, "one bin", kBlue);
    addLegendText(*scene, 1, "kept", kGreen);
    addLegendText(*scene, 0, "rejected", kRed);
    return scene;
}

COpenGLScene::Ptr cloudScene(const Eigen::Matrix3Xf& points) {
    map::MapPoints all(static_cast<std::size_t>(points.cols()));
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i].position = points.col(static_cast<Eigen::Index>(i));
    const auto colours = map::coloursOf(all, {map::ColourBy::Height, map::Colormap::Turbo});
    auto cloud = mrpt::opengl::CPointCloudColoured::Create();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Eigen::Vector3f& p = all[i].position;
        const TColor& c = colours.ofPoints[i];
        cloud->insertPoint({p.x(), p.y(), p.z(), c.R, c.G, c.B});
    }
    cloud->setPointSize(2);
    auto scene = emptyScene();
    scene->insert(cloud);
    return scene;
}

COpenGLScene::Ptr scannerScene(const Eigen::Matrix3Xf& beams) {
    auto scene = emptyScene();
    constexpr double kRadius_m = 0.1, kHead_m = 0.14, kBase_m = 0.1, kBeam_m = 1.2;
    const auto add = [&](double radius_m, double height_m, double z_m, const TColor& colour) {
        auto body = mrpt::opengl::CCylinder::Create(radius_m, radius_m, height_m, 60);
        body->setHasBases(true, true);
        body->setColor_u8(colour);
        body->setLocation(0, 0, z_m);
        scene->insert(body);
    };
    add(1.1 * kRadius_m, kBase_m, -kHead_m / 2 - kBase_m, kInk);
    add(kRadius_m, kHead_m, -kHead_m / 2, TColor(110, 115, 125));
    for (Eigen::Index i = 0; i < beams.cols(); ++i) {
        const double fraction = (static_cast<double>(i) + 0.5) / static_cast<double>(beams.cols());
        auto beam = wideLines(map::colourAt(map::Colormap::Turbo, 1 - fraction), kWidth_px);
        const Eigen::Vector3d n = beams.col(i).cast<double>().normalized();
        appendWide(*beam, 1.1 * kRadius_m * n, kBeam_m * n, kPiece_m / 20);
        scene->insert(beam);
    }
    return scene;
}

struct PaperStages::Lines : public paper::LineCloud {};

PaperStages::PaperStages(const PaperOdometryOptions& options) : options_(options) {}
PaperStages::~PaperStages() = default;

PaperStages::Scenes PaperStages::add(const Scan& scan, const Eigen::Isometry3d& increment) {
    const auto cloud = odometry::preprocess(scan, options_.scan);
    const auto normals = paper::estimateNormals(cloud.points, options_.normals);
    Scenes scenes;
    scenes.pattern =
        sphereScene({paper::removeOutliers(normals, options_.outliers).directions}, {});
    auto lines = std::make_unique<Lines>(
        Lines{paper::drawLines(cloud.points, odometry::neighbouringRings(cloud), options_.lines)});
    if (before_)
        scenes.matches = matchScene(*before_, paper::rotated(*lines, increment.linear()),
                                    increment.translation());
    before_ = std::move(lines);
    return scenes;
}

void illustrate(const run::RunRecord& record, const map::BuiltMap& map,
                const run::RunFolder& folder) {
    using run::RunFolder;
    if (!map.points.empty()) {
        drawMap(record, map, folder);
        if (!map.dynamic.empty()) drawRemoval(record, map, folder.path(RunFolder::kRemovalPicture));
    }
    drawTrajectory(record, folder.path(RunFolder::kTrajectoryPicture));
}
}  // namespace delio::picture
