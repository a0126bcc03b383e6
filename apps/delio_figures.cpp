// delio-figures: the paper's pictures of the stages, made of scans of a recording.
#include <mrpt/3rdparty/tclap/CmdLine.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cli.h"
#include "delio/core/error.h"
#include "delio/files/output.h"
#include "delio/picture/figures.h"
#include "delio/picture/render.h"
#include "delio/picture/scene.h"
#include "delio/recordings/scan_reader.h"
#include "delio/slam/options.h"
#include "delio/version.h"
#include "odometry/paper_odometry.h"
#include "odometry/preprocess.h"
#include "option_sections.h"
#include "overlap.h"
#include "paper/line_cloud.h"
#include "paper/mean_shift.h"
#include "paper/normals.h"
#include "paper/outlier_removal.h"
#include "paper/sphere.h"
#include "picture/line_scenes.h"

namespace {
using namespace delio;

constexpr std::size_t kScans = 4;  // as many as the paper's figure shows

/** Files of the figures, as .3Dscene and .png. */
std::vector<std::string> figureFiles() {
    std::vector<std::string> files;
    for (const std::string name :
         {"scanner", "cloud", "sphere", "normals_sphere", "outlier_removal", "mean_shift",
          "line_bin", "line_cloud", "line_matches_before", "line_matches_after"})
        for (const char* kind : {".3Dscene", ".png"}) files.push_back(name + kind);
    return files;
}

/** Throws Error if an output is an input, or exists and --force is not given. */
void checkFiles(const std::string& input, const std::string& folder, bool force) {
    std::vector<std::string> outputs;
    for (const auto& file : figureFiles()) outputs.push_back(folder + "/" + file);
    cli::refuseOverlap(cli::filesOfRawlog(input), outputs);
    for (const auto& output : outputs) cli::refuseExisting(output, force);
}

/** The figures' folder; they get there when all are drawn. */
class Figures {
 public:
    explicit Figures(const std::string& folder)
        : folder_(folder), target_(folder), partial_(folder, folder) {}

    void save(const std::string& name, mrpt::opengl::COpenGLScene& scene,
              const picture::SnapshotOptions& view) const {
        const std::string path = partial_.path() / name;
        try {
            picture::saveScene(scene, path + ".3Dscene");
            picture::savePicture(scene, view, path + ".png");
        } catch (const Error& e) {
            throw Error(partial_.asInPlace(e.what()));
        }
    }

    void finish() {
        partial_.putInPlace(figureFiles());
        cli::inform("wrote " + std::to_string(figureFiles().size()) + " files to '" + folder_ +
                    "'");
    }

 private:
    std::string folder_;
    io::TargetFolder target_;
    io::PartialFolder partial_;
};

std::vector<Scan> readScans(io::ScanReader& reader, const std::string& input, std::size_t first,
                            std::size_t every) {
    for (std::size_t i = 0; i < first; ++i)
        if (!reader.skip()) break;
    std::vector<Scan> scans;
    while (scans.size() < kScans) {
        auto scan = reader.next();
        if (!scan) break;
        scans.push_back(std::move(*scan));
        for (std::size_t i = 1; i < every; ++i)
            if (!reader.skip()) break;
    }
    if (scans.size() < 2)
        throw Error("'" + input + "' has fewer than two scans from scan " + std::to_string(first) +
                    " on");
    return scans;
}

paper::SurfaceNormals normalsOf(const Scan& scan, const PaperOdometryOptions& options) {
    const auto cloud = odometry::preprocess(scan, options.scan);
    return paper::surfacesOf(cloud.points, options.normals, options.bilateral);
}

/** The pattern of scans that follow each other: it moves as the vehicle turns. */
void drawPatterns(const std::vector<Scan>& scans, const PaperOdometryOptions& options,
                  const Figures& figures) {
    std::vector<Eigen::Matrix3Xf> patterns;
    std::vector<std::string> captions;
    for (const auto& scan : scans) {
        patterns.push_back(
            paper::removeOutliers(normalsOf(scan, options), options.outliers).directions);
        captions.push_back("scan " + std::to_string(scan.index));
    }
    figures.save("normals_sphere", *picture::sphereScene(patterns, captions),
                 picture::sphereView(patterns.size()));
    figures.save("sphere", *picture::sphereScene({patterns[0]}, {}), picture::sphereView(1));
}

/** All normals of a scan, and what outlier removal leaves of them in steps of about as many rounds.
 */
void drawOutlierRemoval(const Scan& scan, const PaperOdometryOptions& options,
                        const Figures& figures) {
    const auto normals = normalsOf(scan, options);
    std::vector<Eigen::Matrix3Xf> steps;
    std::vector<std::string> captions;
    const unsigned rounds = paper::removeOutliers(normals, options.outliers).rounds;
    const auto shown = std::min<unsigned>(kScans - 1, rounds);
    for (unsigned step = 0; step <= shown; ++step) {
        const unsigned round = shown == 0 ? 0 : step * rounds / shown;
        steps.push_back(
            paper::removeOutliers(normals, options.outliers.firstRounds(round)).directions);
        captions.push_back(std::to_string(steps.back().cols()) + " normals");
    }
    figures.save("outlier_removal", *picture::sphereScene(steps, captions),
                 picture::sphereView(steps.size()));
}

/** The mean shift of a scan, whether its pattern needs it or not. */
void drawMeanShift(const Scan& scan, const PaperOdometryOptions& options, const Figures& figures) {
    const auto normals = normalsOf(scan, options);
    const auto seeds = paper::sphereGrid(options.meanShift.seed_spacing_deg);
    const auto modes = paper::seekModes(normals.directions, options.meanShift);
    const auto pattern =
        paper::patternOfModes(normals, modes, options.meanShift, options.outliers).directions;
    figures.save("mean_shift",
                 *picture::meanShiftScene(normals.directions, seeds.cast<float>(), modes,
                                          options.meanShift.window_deg, pattern),
                 picture::sphereView(3));
}

/** For a column of print; seen from above, +x to the right. */
picture::SnapshotOptions columnView() {
    picture::SnapshotOptions view = picture::topView();
    view.width_px = 1600;
    view.height_px = 900;
    view.azimuth_deg = -90;
    view.marks = 4;
    return view;
}

double azimuthOf(const Eigen::Vector3f& p) { return std::atan2(p.y(), p.x()); }

/** A scan as lines are drawn in it. */
struct RingedScan {
    RingedScan(const Scan& scan, const PaperOdometryOptions& options) {
        auto cloud = odometry::preprocess(scan, options.scan);
        rings = odometry::neighbouringRings(cloud);
        points = std::move(cloud.points);
        scale = scaleOf(scan);
    }

    std::uint16_t ringOf(Eigen::Index i) const { return rings[static_cast<std::size_t>(i)]; }

    Eigen::Matrix3Xf points;           // metres, sensor's frame
    std::vector<std::uint16_t> rings;  // of each point, from the top
    double scale = 1;                  // of the place: 1 for streets, less for rooms
};

/** The scanner with the beam of each ring that points ahead, and the cloud around it. */
void drawTeaser(const RingedScan& scan, const Figures& figures) {
    std::map<std::uint16_t, Eigen::Vector3f> ahead;
    std::vector<Eigen::Index> near;
    constexpr float kNear_m = 40;
    for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
        const Eigen::Vector3f p = scan.points.col(i);
        const auto beam = ahead.emplace(scan.ringOf(i), p).first;
        if (std::abs(azimuthOf(p)) < std::abs(azimuthOf(beam->second))) beam->second = p;
        if (p.head<2>().norm() < kNear_m) near.push_back(i);
    }
    constexpr double kAhead = 0.02;  // rad
    Eigen::Matrix3Xf beams(3, 0);
    for (const auto& [ring, p] : ahead) {
        if (std::abs(azimuthOf(p)) > kAhead) continue;
        beams.conservativeResize(3, beams.cols() + 1);
        beams.rightCols(1) = p;
    }
    picture::SnapshotOptions view = columnView();
    view.width_px = 800;
    view.height_px = 600;
    view.ortho = false;
    view.elevation_deg = 12;
    figures.save("scanner", *picture::scannerScene(beams), view);
    view.elevation_deg = 40;
    figures.save("cloud", *picture::cloudScene(scan.points(Eigen::all, near)), view);
}

/** A bin of the polar grid: a sector between ring `ring` and the next one. */
struct Bin {
    int ring = -1;
    double azimuth = 0;  // of its middle, rad
    double range_m = 0;  // of its middle
    Eigen::Vector3d middle() const {
        return {range_m * std::cos(azimuth), range_m * std::sin(azimuth), 0};
    }
};

/** The bin that shows lines best: both its rings are even and lie some way apart, as they do on
 *  the ground, and around it are steps. Where no bin is like that, any bin. Throws Error if
 * there are no bins. */
Bin tellingBin(const RingedScan& scan, int sectors) {
    const int rings =
        scan.rings.empty() ? 0 : 1 + *std::max_element(scan.rings.begin(), scan.rings.end());
    Eigen::MatrixXd near = Eigen::MatrixXd::Constant(rings, sectors, 1e9);
    Eigen::MatrixXd far = Eigen::MatrixXd::Zero(rings, sectors);
    for (Eigen::Index i = 0; i < scan.points.cols(); ++i) {
        const Eigen::Vector3f p = scan.points.col(i);
        const double range = double{p.head<2>().norm()};
        const int sector =
            std::min(sectors - 1, static_cast<int>((azimuthOf(p) / (2 * M_PI) + 0.5) * sectors));
        near(scan.ringOf(i), sector) = std::min(near(scan.ringOf(i), sector), range);
        far(scan.ringOf(i), sector) = std::max(far(scan.ringOf(i), sector), range);
    }
    const auto spread = [&](int ring, int sector) {
        sector = (sector + sectors) % sectors;
        return ring < 0 || ring >= rings ? -1 : far(ring, sector) - near(ring, sector);
    };
    const double m = scan.scale;
    Bin bin;
    double best = -1e9;
    for (int ring = 0; ring + 1 < rings; ++ring)
        for (int sector = 0; sector < sectors; ++sector) {
            if (spread(ring, sector) < 0 || spread(ring + 1, sector) < 0) continue;
            const double apart = std::abs(near(ring, sector) - near(ring + 1, sector));
            const bool isGood = near(ring + 1, sector) > 6 * m && far(ring, sector) < 14 * m &&
                                apart > 0.5 * m && apart < 2 * m && spread(ring, sector) < m &&
                                spread(ring + 1, sector) < m;
            double steps = isGood ? 100 : 0;
            for (int other = ring - 1; other <= ring + 2; ++other)
                for (const int side : {-1, 0, 1}) {
                    const double step = spread(other, sector + side);
                    steps +=
                        step < 0 || step > 4 * m ? -4 * m : step;  // missing, or too large to show
                }
            if (steps <= best) continue;
            best = steps;
            bin = {ring, ((sector + 0.5) / sectors - 0.5) * 2 * M_PI,
                   (near(ring, sector) + near(ring + 1, sector)) / 2};
        }
    if (bin.ring < 0) throw Error("the first scan has no two rings beside each other");
    return bin;
}

/** One bin of the polar grid, the rings around it, and the lines drawn and kept there. */
void drawBin(const RingedScan& scan, const Bin& bin, const LineCloudOptions& options,
             const Figures& figures) {
    const Eigen::Matrix3d ahead =
        Eigen::AngleAxisd(-bin.azimuth, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Matrix3Xf turned = ahead.cast<float>() * scan.points;
    const double width = 2 * M_PI / options.sectors;
    std::vector<Eigen::Index> shown;
    std::vector<std::uint16_t> rings;
    std::vector<std::vector<Eigen::Index>> inside(2);  // of the bin's rings, in order of azimuth
    for (Eigen::Index i = 0; i < turned.cols(); ++i) {
        const double sectors = std::abs(azimuthOf(turned.col(i))) / width;  // from the middle
        const int ring = scan.ringOf(i) - bin.ring;
        if (sectors > 1.5 || ring < -1 || ring > 2) continue;
        shown.push_back(i);
        rings.push_back(scan.ringOf(i));
        if (sectors < 0.5 && (ring == 0 || ring == 1))
            inside[static_cast<std::size_t>(ring)].push_back(i);
    }
    for (auto& ring : inside)
        std::sort(ring.begin(), ring.end(), [&](Eigen::Index a, Eigen::Index b) {
            return azimuthOf(turned.col(a)) < azimuthOf(turned.col(b));
        });
    std::vector<Eigen::Index> outline = inside[0];
    outline.insert(outline.end(), inside[1].rbegin(), inside[1].rend());
    auto all = options;
    all.kept = all.drawn;
    all.max_length = 1e6;
    const Eigen::Matrix3Xf points = scan.points(Eigen::all, shown);
    figures.save(
        "line_bin",
        *picture::binScene(turned(Eigen::all, shown), turned(Eigen::all, outline),
                           paper::rotated(paper::drawLines(points, rings, all), ahead),
                           paper::rotated(paper::drawLines(points, rings, options), ahead)),
        columnView());
}

/** Lines with midpoints so near to a place, seen from above. */
paper::LineCloud within(const paper::LineCloud& lines, const Eigen::Vector3d& place,
                        double radius_m) {
    std::vector<Eigen::Index> inside;
    for (Eigen::Index i = 0; i < lines.lengths.size(); ++i) {
        const Eigen::Vector3d away = lines.midpoints.col(i).cast<double>() - place;
        if (away.head<2>().norm() < radius_m) inside.push_back(i);
    }
    return picture::someOf(lines, inside);
}

/** The line cloud of a scan, and the pairs with the next one's before and after registration. */
void drawLines(const std::vector<Scan>& scans, const Bin& bin, double scale,
               const PaperOdometryOptions& options, const Figures& figures) {
    odometry::PaperOdometry method(options);
    const Step first = method.process(scans[0]), second = method.process(scans[1]);
    const auto linesOf = [](const Step& step) -> const paper::LineCloud& {
        return std::static_pointer_cast<const odometry::PaperFeatures>(step.features)->lines;
    };
    const Eigen::Isometry3d& pose = second.increment.pose;
    const paper::LineCloud& from = linesOf(first);
    const paper::LineCloud to = paper::rotated(linesOf(second), pose.linear());
    const double far_m = 25 * scale, near_m = 5 * scale;
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    const auto all = picture::lineScene(within(from, none, far_m));
    picture::addCircle(*all, none, far_m);
    figures.save("line_cloud", *all, columnView());
    const Eigen::Vector3d place = bin.middle();
    const auto drawMatches = [&](const std::string& name, const Eigen::Vector3d& t) {
        const auto scene =
            picture::matchScene(within(from, place, near_m), within(to, place - t, near_m), t);
        picture::addCircle(*scene, place, near_m);
        figures.save(name, *scene, columnView());
    };
    drawMatches("line_matches_before", none);
    drawMatches("line_matches_after", pose.translation());
}

/** Options of the paper's stages from the command line. Throws Error as Options does. */
PaperOdometryOptions optionsFor(const std::string& profile, const io::ScanReader& reader,
                                const std::vector<std::string>& assignments) {
    Options options = Options::forDrive(profile, reader.meta());
    for (const auto& assignment : assignments) options.set(assignment);
    options.method.method = "paper";  // whose stages are drawn, whatever the profile goes by
    options.check();
    return options.paper;
}

cli::HelpText help() {
    cli::HelpText help;
    help.about = "Shows four scans: consecutive ones, or each Nth with --every.";
    help.sections = cli::optionSections(stagesOf(Options::ofProfile("paper")));
    help.sections.erase(help.sections.begin());  // the odometry cannot be chosen
    help.writes = {
        {"scanner", "scanner with one beam per ring"},
        {"cloud", "point cloud of the first scan"},
        {"sphere", "its pattern of normals on the sphere"},
        {"normals_sphere", "pattern of normals on the sphere, per scan"},
        {"outlier_removal", "the same for the first scan, after each round of outlier removal"},
        {"mean_shift", "seeds, windows and modes of the mean shift in the first scan"},
        {"line_bin", "rings, one bin, lines kept and rejected in the first scan"},
        {"line_cloud", "line cloud of the first scan"},
        {"line_matches_before", "matched lines of two scans before registration"},
        {"line_matches_after", "the same after registration; all as .png and .3Dscene"}};
    help.examples = {{{"delio-figures -i 07.rawlog -o figures --scan 100", "Draw scans 100 to 103"},
                      {"delio-figures -i 07.rawlog -o few --set outlier_removal.rounds=1",
                       "Use one round of outlier removal"}}};
    help.interrupted = "existing files are unchanged";
    return help;
}
}  // namespace

int main(int argc, char** argv) {
    TCLAP::CmdLine cmd("draws the paper's figures from scans of a recording", ' ', kVersion);
    using Text = TCLAP::ValueArg<std::string>;
    Text input("i", "input", "Recording: see delio-slam", true, "", "IN", cmd);
    Text output("o", "output", "Folder for the figures", true, "", "OUTDIR", cmd);
    TCLAP::ValueArg<cli::Count> scan("", "scan", "First scan to draw, counted from 0", false, {},
                                     "N", cmd);
    TCLAP::ValueArg<cli::Count> every("", "every",
                                      "Draw each Nth scan: in a bend the pattern turns visibly",
                                      false, {1}, "N", cmd);
    Text profile("", "profile", "Preset for all options that you do not set yourself", false,
                 "paper", cli::profileChoice(), cmd);
    TCLAP::MultiArg<std::string> set(
        "", "set", "Set one option; delio-slam --profile paper --print-config lists all of them",
        false, "section.key=value", cmd);
    TCLAP::SwitchArg force("", "force", "Overwrite existing files", cmd);
    TCLAP::SwitchArg verbose("", "verbose", "Print full error texts", cmd);

    return cli::run(cmd, help(), argc, argv, verbose, [&] {
        checkFiles(input.getValue(), output.getValue(), force.getValue());
        if (every.getValue() == 0) {
            cli::inform("--every has to be 1 or more");
            return cli::kExitBadCommandLine;
        }
        const auto reader = io::openScans(input.getValue());
        PaperOdometryOptions options;
        try {
            options = optionsFor(profile.getValue(), *reader, set.getValue());
        } catch (const Error& e) {
            cli::inform(e.what());
            return cli::kExitBadCommandLine;
        }
        const auto scans = readScans(*reader, input.getValue(), scan.getValue(), every.getValue());
        Figures figures(output.getValue());
        drawPatterns(scans, options, figures);
        drawOutlierRemoval(scans[0], options, figures);
        drawMeanShift(scans[0], options, figures);
        const RingedScan ringed(scans[0], options);
        const Bin bin = tellingBin(ringed, static_cast<int>(options.lines.sectors));
        drawTeaser(ringed, figures);
        drawBin(ringed, bin, options.lines, figures);
        drawLines(scans, bin, ringed.scale, options, figures);
        figures.finish();
        return cli::kExitSuccess;
    });
}
